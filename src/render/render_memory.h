/// The estimate behind --max-memory: bytes that a render takes beside its scene, told before it
/// begins. cli/memory_limit.h holds it against the option.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "render/film.h"
#include "render/options.h"

namespace covtrace {

/// Bytes that a render keeps for each pixel, plan and prediction included, at the moment when they
/// are most. `parts`: the records that are kept beside
/// pixels; of the first two the other methods have their own.
size_t film_bytes_per_pixel(Method method, FilmParts parts = {});

/// Bytes that a render takes beside its scene: "film", with plan and prediction, and "image": the
/// layers and the buffers of the reconstruction, as measured; "denoiser" where there is one.
/// `keeps_opacity`: FilmParts::opacity.
std::map<std::string, size_t> render_memory(const FilmDescription& film,
                                            const RenderOptions& options, bool keeps_opacity);

}  // namespace covtrace
