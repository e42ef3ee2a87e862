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

/// The beginnings of such files, by which they are known without a name.
struct ForeignBeginning {
    std::string_view bytes, name;
};
constexpr std::array<ForeignBeginning, 8> kForeignBeginnings{
    {{"BLENDER", "a file of Blender"},
     {"\x28\xb5\x2f\xfd", "a file compressed by zstd, as Blender's,"},
     {"#usda", "a USD stage"},
     {"PXR-USDC", "a USD stage"},
     {"PK\x03\x04", "a ZIP archive, as a USD package,"},
     {"<", "XML, as a scene of Mitsuba,"},
     {"ply", "a PLY mesh"},
     {"\x1f\x8b", "a file compressed by gzip (zcat unpacks it)"}}};

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

SceneDescription read_scene_bytes(const std::string& bytes, const std::string& name,
                                  const ReadOptions& options) {
    for (const ForeignBeginning& foreign : kForeignBeginnings)
        if (bytes.starts_with(foreign.bytes))
            throw Error(ErrorKind::scene,
                        name + ": " + std::string(foreign.name) +
                            " is no scene of a format that is read; expected pbrt-v4 or glTF 2.0");
    const size_t first = bytes.find_first_not_of(" \t\r\n");
    const bool is_json = first != std::string::npos && bytes[first] == '{';
    SceneDescription scene = is_json || bytes.starts_with("glTF")
                                 ? read_gltf_bytes(bytes, name, {}, options)
                                 : read_pbrt_string(bytes, name, {}, options);
    scene.name = "scene";
    return scene;
}

}  // namespace covtrace
