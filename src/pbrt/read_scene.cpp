#include "pbrt/read_scene.h"

#include "pbrt/scene_parser.h"
#include "scene/names.h"
#include "scene/with_limits.h"

namespace covtrace {

namespace {

namespace fs = std::filesystem;

SceneDescription read(std::string text, const std::string& name, SceneFiles& files,
                      WarningLog& log) {
    SceneDescription scene;
    fs::path stem = fs::path(name).filename();
    if (stem.extension() == ".gz") stem = stem.stem();
    scene.name = stem.stem().string();
    SceneBuilder builder(scene, files, log);
    TokenStream tokens(std::move(text), name, files);
    parse_directives(tokens, builder, files, log);
    builder.finish(tokens.next().where());
    scene.warnings = log.take();
    scene.content_hash = files.content_hash();
    scene.files = files.files();
    return scene;
}

/// Refuses choices that no pbrt file offers.
void refuse_choices(const ReadOptions& options) {
    if (!options.camera.empty())
        throw Error(ErrorKind::usage, OptionName{"camera"},
                    in_quotes(options.camera) +
                        " names a camera, and pbrt files have one without a name; expected a "
                        "pinhole such as 'eye 0,1,6 target 0,0,0 fov 40'");
    if (!options.gltf_scene.empty())
        throw Error(ErrorKind::usage, OptionName{"gltf_scene"},
                    "pbrt files have one scene; expected a glTF file");
    if (options.is_frame)
        throw Error(ErrorKind::usage, OptionName{"frames"},
                    "pbrt files are one frame each; expected a glTF file");
    if (!options.variant.empty())
        throw Error(ErrorKind::usage, OptionName{"variant"},
                    "pbrt files have no variants of materials; expected a glTF file");
    if (!options.animation.empty())
        throw Error(ErrorKind::usage, OptionName{"animation"},
                    "pbrt files have no animations by name; expected a glTF file");
}

}  // namespace

SceneDescription read_pbrt(const fs::path& file, const ReadOptions& options) {
    refuse_choices(options);
    const std::string name = file.string();
    return with_limits(name, [&] {
        WarningLog log;
        SceneFiles files(file.parent_path(), options.search_paths, log);
        std::string text = files.read(file, {});
        return read(std::move(text), name, files, log);
    });
}

SceneDescription read_pbrt_string(std::string_view text, std::string name, const fs::path& folder,
                                  const ReadOptions& options) {
    refuse_choices(options);
    return with_limits(name, [&] {
        WarningLog log;
        SceneFiles files(folder, options.search_paths, log);
        files.add_to_hash(hash_of(text));
        return read(std::string(text), name, files, log);
    });
}

}  // namespace covtrace
