#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "cli/commands.h"
#include "cli/override_options.h"
#include "cli/scene_input.h"
#include "core/error.h"
#include "image/image.h"
#include "render/describe_state.h"
#include "render/film_file.h"
#include "render/overrides.h"
#include "render/scene_file.h"
#include "scene/summary.h"

namespace covtrace::cli {

namespace {

struct InfoArguments {
    std::string file;
    SceneOverrides overrides;
    ReadOptions reading;
};

/// Throws Error(usage) where an option chooses something of a scene, and there is none.
void require_no_choice(const InfoArguments& a, const std::string& kind) {
    const ReadOptions& r = a.reading;
    const std::pair<const char*, bool> choices[] = {
        {"camera", a.overrides.camera || !r.camera.empty()},
        {"gltf_scene", !r.gltf_scene.empty()},
        {"animation", !r.animation.empty()},
        {"variant", !r.variant.empty()}};
    for (const auto& [option, is_given] : choices)
        if (is_given)
            throw Error(ErrorKind::usage, OptionName{option},
                        "'" + a.file + "' is " + kind + "; expected a scene");
}

}  // namespace

void add_info(CLI::App& app, Invocation& invocation) {
    auto a = std::make_shared<InfoArguments>();
    CLI::App* c = app.add_subcommand("info", "Tell what a scene, image or film holds");
    c->add_option("FILE", a->file, "a scene or -, an image or a film")
        ->required()
        ->option_text(" ");
    add_choice_options(c, a->overrides, a->reading);
    c->callback([a, &invocation] {
        invocation.action = [a] {
            const std::filesystem::path path = a->file;
            const bool is_piped = a->file == kStandardInput;
            if (!is_piped && is_film(path)) {
                require_no_choice(*a, "a film");
                fmt::print("{}", describe(read_film(path)));
                return 0;
            }
            if (is_piped || is_scene_file(path)) {
                SceneDescription scene = read_scene(a->file, a->reading);
                apply(a->overrides, scene);
                fmt::print("{}", summarize(scene));
                return 0;
            }
            const Image image = read_image(path);
            require_no_choice(*a, "an image");
            fmt::print("{}", describe(image));
            return 0;
        };
    });
}

}  // namespace covtrace::cli
