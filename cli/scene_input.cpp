#include "cli/scene_input.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <vector>

#include "core/error.h"
#include "render/scene_file.h"

namespace covtrace::cli {

namespace {

std::string standard_input() {
    std::string bytes;
    std::vector<char> block(1 << 20);
    while (const size_t count = std::fread(block.data(), 1, block.size(), stdin))
        bytes.append(block.data(), count);
    if (std::ferror(stdin))
        throw Error(ErrorKind::io,
                    std::string("cannot read standard input: ") + std::strerror(errno));
    return bytes;
}

}  // namespace

SceneDescription read_scene(const std::string& scene, const ReadOptions& options) {
    if (scene != kStandardInput) return read_scene_file(scene, options);
    return read_scene_bytes(standard_input(), "standard input", options);
}

}  // namespace covtrace::cli
