#include "render/scene_file.h"

#include "gltf/read_gltf.h"

namespace covtrace {

bool is_scene_file(const std::filesystem::path& file) {
    return is_gltf(file) || file.extension() == ".pbrt" || file.string().ends_with(".pbrt.gz");
}

SceneDescription read_scene_file(const std::filesystem::path& file, const ReadOptions& options) {
    return is_gltf(file) ? read_gltf(file, options) : read_pbrt(file, options);
}

}  // namespace covtrace
