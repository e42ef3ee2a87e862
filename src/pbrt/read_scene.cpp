#include "pbrt/read_scene.h"

#include "pbrt/scene_parser.h"
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

}  // namespace

SceneDescription read_pbrt(const fs::path& file, const ReadOptions& options) {
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
    return with_limits(name, [&] {
        WarningLog log;
        SceneFiles files(folder, options.search_paths, log);
        files.add_to_hash(hash_of(text));
        return read(std::string(text), name, files, log);
    });
}

}  // namespace covtrace
