#include "render/scene_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>
#include <system_error>

#include "gltf/read_gltf.h"
#include "pbrt/read_scene.h"

namespace covtrace {

namespace {

/// A format of scenes that people have and that is not read, known by the ending of its files.
struct ForeignFormat {
    std::string_view ending, name;
};
constexpr std::array<ForeignFormat, 15> kForeign{{{".blend", "a file of Blender"},
                                                  {".usd", "a USD stage"},
                                                  {".usda", "a USD stage"},
                                                  {".usdc", "a USD stage"},
                                                  {".usdz", "a USD package"},
                                                  {".xml", "XML, as a scene of Mitsuba"},
                                                  {".obj", "a Wavefront mesh"},
                                                  {".fbx", "an FBX scene"},
                                                  {".dae", "a COLLADA scene"},
                                                  {".abc", "an Alembic archive"},
                                                  {".stl", "an STL mesh"},
                                                  {".ply", "a PLY mesh"},
                                                  {".max", "a file of 3ds Max"},
                                                  {".ma", "a file of Maya"},
                                                  {".mb", "a file of Maya"}}};

const ForeignFormat* foreign_format(const std::filesystem::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const auto found = std::find_if(kForeign.begin(), kForeign.end(),
                                    [&](const ForeignFormat& f) { return f.ending == ending; });
    return found == kForeign.end() ? nullptr : &*found;
}

}  // namespace

bool is_scene_file(const std::filesystem::path& file) {
    return is_gltf(file) || file.extension() == ".pbrt" || file.string().ends_with(".pbrt.gz") ||
           foreign_format(file);
}

SceneDescription read_scene_file(const std::filesystem::path& file, const ReadOptions& options) {
    const ForeignFormat* foreign = foreign_format(file);
    std::error_code ignored;
    if (foreign && std::filesystem::is_regular_file(file, ignored))
        throw Error(ErrorKind::scene,
                    file.string() + ": " + std::string(foreign->name) +
                        " is no scene of a format that is read; expected pbrt-v4 (.pbrt) or glTF "
                        "2.0 (.gltf, .glb)" +
                        (foreign->ending == ".blend"
                             ? "; the add-on in 'blender/' renders and exports from Blender"
                             : ""));
    return is_gltf(file) ? read_gltf(file, options) : read_pbrt(file, options);
}

}  // namespace covtrace
