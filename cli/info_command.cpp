#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "cli/commands.h"
#include "cli/scene_input.h"
#include "image/image.h"
#include "render/describe_state.h"
#include "render/film_file.h"
#include "render/scene_file.h"
#include "scene/defaults.h"
#include "scene/summary.h"

namespace covtrace::cli {

void add_info(CLI::App& app, Invocation& invocation) {
    auto file = std::make_shared<std::string>();
    CLI::App* c = app.add_subcommand("info", "Tell what a scene, image or film holds");
    c->add_option("FILE", *file, "a scene or -, an image or a film")->required()->option_text(" ");
    c->callback([file, &invocation] {
        invocation.action = [file] {
            const std::filesystem::path path = *file;
            const bool is_piped = *file == kStandardInput;
            if (!is_piped && is_film(path)) {
                fmt::print("{}", describe(read_film(path)));
                return 0;
            }
            if (is_piped || is_scene_file(path)) {
                SceneDescription scene = read_scene(*file);
                complete(scene);
                fmt::print("{}", summarize(scene));
                return 0;
            }
            fmt::print("{}", describe(read_image(path)));
            return 0;
        };
    });
}

}  // namespace covtrace::cli
