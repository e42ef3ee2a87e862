#include "cli/memory_limit.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "core/error.h"

namespace covtrace::cli {

namespace {

/// Bytes that the process has in memory now; 0 where the system does not tell.
size_t resident_bytes() {
    size_t pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    return resident * size_t(sysconf(_SC_PAGE_SIZE));
}

std::string megabytes(size_t bytes) {
    return fmt::format("{:.1f}M", double(bytes) / double(1 << 20));
}

}  // namespace

void require_memory(size_t most, const std::map<std::string, size_t>& coming,
                    const RenderScene* scene) {
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
    parts[scene ? "program" : "program and scene"] += now - std::min(now, known);
    std::string list;
    for (const auto& [name, bytes] : parts)
        list += (list.empty() ? "" : ", ") + name + " " + megabytes(bytes);
    throw Error(ErrorKind::limit, fmt::format("--max-memory: the render needs {}, more than {}: {}",
                                              megabytes(sum), megabytes(most), list));
}

}  // namespace covtrace::cli
