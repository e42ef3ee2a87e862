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
/// are most. `uniform_parts`: the records that `uniform` keeps beside its pixels.
size_t film_bytes_per_pixel(Method method, FilmParts uniform_parts = {});

/// Bytes that a render takes beside its scene: "film", with plan and prediction, and "image": the
/// layers and the buffers of the reconstruction, as measured; "denoiser" where there is one.
std::map<std::string, size_t> render_memory(const FilmDescription& film,
                                            const RenderOptions& options);

}  // namespace covtrace
