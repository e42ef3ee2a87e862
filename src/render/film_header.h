/// The header of a film file: a render's state without its arrays, as JSON.
#pragma once

#include <string>

#include "render/render_state.h"

namespace covtrace {

std::string film_header(const RenderState& state);

/// Of film files: the one that is written, and the first one that is still read.
constexpr uint32_t kFilmFormat = 4, kOldestFilmFormat = 3;

/// The version that wrote the film: that of the program and its commit. Empty where the text does
/// not tell.
std::string version_of_film(const std::string& header);

/// A state with arrays of the right size, filled with zeros. `most_bytes` limits them; `format`:
/// of the file. Throws Error(scene) for text that is no header, Error(limit) beyond the limit.
RenderState parse_film_header(const std::string& text, size_t most_bytes,
                              uint32_t format = kFilmFormat);

}  // namespace covtrace
