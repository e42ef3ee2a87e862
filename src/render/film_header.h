/// The header of a film file: a render's state without its arrays, as JSON.
#pragma once

#include <string>

#include "render/render_state.h"

namespace covtrace {

std::string film_header(const RenderState& state);

/// Formats of film files: the one that is written, and the oldest one that is still read.
constexpr uint32_t kFilmFormat = 4, kOldestFilmFormat = 3;

/// The version of the program, with its commit, that wrote the film. Empty where the text does not
/// tell.
std::string version_of_film(const std::string& header);

/// Reads a header into a state with arrays of the right size, filled with zeros. `most_bytes`
/// limits the arrays; `format` is that of the file. Throws Error(scene) for text that is no header,
/// Error(limit) beyond the limit.
RenderState parse_film_header(const std::string& text, size_t most_bytes,
                              uint32_t format = kFilmFormat);

}  // namespace covtrace
