#include "cli/override_options.h"

#include "cli/options.h"
#include "cli/values.h"

namespace covtrace::cli {

namespace {

void add_environment(CLI::App* c, SceneOverrides& o) {
    const auto parse = [&o](const std::string& text) {
        o.environment = parse_environment("--environment", text);
    };
    c->add_option_function<std::string>("--environment", parse,
                                        "light from all around: image or r,g,b")
        ->option_text("FILE|COLOUR");
    const auto turn = [&o](const std::string& text) {
        o.environment_rotation = parse_degrees("--environment-rotation", text);
    };
    c->add_option_function<std::string>("--environment-rotation", turn,
                                        "turn it about the scene's up axis")
        ->option_text("DEGREES");
    add_positive(c, "--environment-scale", o.environment_scale, 1e12, "make it brighter or darker");
}

}  // namespace

void add_override_options(CLI::App* c, SceneOverrides& o) {
    c->add_option_function<std::string>(
         "--resolution",
         [&o](const std::string& text) { o.resolution = parse_resolution("--resolution", text); },
         "in place of the scene's")
        ->option_text("WxH");
    c->add_option_function<std::string>(
         "--shutter",
         [&o](const std::string& text) { o.shutter = parse_interval("--shutter", text); },
         "in place of the scene's")
        ->option_text("T0,T1");
    add_positive(c, "--focus", o.focal_distance, 1e30, "focal distance in place of the scene's",
                 SceneOverrides::kLeastOfLens);
    add_positive(c, "--fstop", o.f_number, 1e30, "lens by f-number (full-frame sensor, metres)",
                 SceneOverrides::kLeastOfLens);
    c->add_option_function<std::string>(
         "--camera", [&o](const std::string& text) { o.camera = parse_camera("--camera", text); },
         "a pinhole: 'eye x,y,z target x,y,z fov N'")
        ->option_text("TEXT");
    add_environment(c, o);
}

}  // namespace covtrace::cli
