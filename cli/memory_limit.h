/// The option --max-memory: the estimate of render/render_memory.h against the limit. While files
/// are read, core/memory_limit.h keeps to it.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "integrator/render_scene.h"

namespace covtrace::cli {

/// Throws Error(limit), with the sum by category, where the bytes that the process holds now and
/// those that are `coming` are more than `most`. `scene` tells the use of the bytes so far.
void require_memory(size_t most, const std::map<std::string, size_t>& coming,
                    const RenderScene* scene = nullptr);

}  // namespace covtrace::cli
