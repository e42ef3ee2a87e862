#include "cli/memory_limit.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/memory_limit.h"

namespace covtrace::cli {

namespace {

/// A size as --max-memory takes it, where M is 2^20 bytes: "512.0M".
std::string megabytes(size_t bytes) {
    return fmt::format("{:.1f}M", double(bytes) / double(1 << 20));
}

}  // namespace

void require_memory(size_t most, const std::map<std::string, size_t>& coming,
                    const RenderScene* scene) {
    return_freed_memory();
    const size_t now = resident_bytes();
    std::map<std::string, size_t> parts = coming;
    size_t known = 0, sum = now;
    for (const auto& [name, bytes] : coming) sum += bytes;
    if (sum <= most) return;
    if (scene)
        for (const auto& [name, bytes] : scene->memory()) {
            parts[name] += bytes;
            known += bytes;
        }
    // The scene does not list all that the process holds: its code, buffers, libraries.
    parts[scene ? "program" : "program and scene"] += now - std::min(now, known);
    std::string list;
    for (const auto& [name, bytes] : parts)
        list += (list.empty() ? "" : ", ") + name + " " + megabytes(bytes);
    throw Error(ErrorKind::limit, fmt::format("--max-memory: the render needs {}, more than {}: {}",
                                              megabytes(sum), megabytes(most), list));
}

}  // namespace covtrace::cli
