#include "cli/override_options.h"

#include <limits>

#include "cli/options.h"
#include "cli/values.h"

namespace covtrace::cli {

namespace {

void add_lights(CLI::App* c, SceneOverrides& o) {
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
                                        "degrees about the scene's up axis")
        ->option_text("N");
    add_positive(c, "--environment-scale", o.environment_scale, 1e12, "make it brighter or darker");
    const auto add_lamp = [&o](const std::vector<std::string>& texts) {
        o.lamps.clear();
        for (const std::string& text : texts) o.lamps.push_back(parse_lamp("--light", text));
    };
    c->add_option_function<std::vector<std::string>>(
         "--light", add_lamp, "a lamp, 'x,y,z power N' or 'camera'; repeatable")
        ->allow_extra_args(false)
        ->take_all()
        ->option_text("camera|TEXT");
}

/// Adds an option for the name or number of something in the file.
void add_choice_of(CLI::App* c, const std::string& name, std::string& value,
                   const std::string& help, const std::string& values) {
    c->add_option(name, value, help)->check(not_empty())->option_text(values);
}

}  // namespace

void add_choice_options(CLI::App* c, SceneOverrides& o, ReadOptions& r) {
    // The last one of several holds, whether by name or by place.
    const auto set_camera = [&o, &r](const std::string& text) {
        const bool is_name = names_camera(text);
        r.camera = is_name ? text : "";
        o.camera = is_name ? std::nullopt : std::optional(parse_camera("--camera", text));
    };
    c->add_option_function<std::string>("--camera", set_camera,
                                        "by name, or 'eye x,y,z target x,y,z fov N'")
        ->option_text("NAME|N|TEXT");
    add_choice_of(c, "--gltf-scene", r.gltf_scene, "one of a glTF file's scenes", "NAME|N");
    add_choice_of(c, "--animation", r.animation, "one of a glTF file's animations",
                  "NAME|N|none|all");
    add_choice_of(c, "--variant", r.variant, "one of a glTF file's variants", "NAME|N");
}

void add_override_options(CLI::App* c, SceneOverrides& o, ReadOptions& r) {
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
    add_whole(c, "--max-depth", o.max_depth, 0, std::numeric_limits<int>::max(),
              "most scattering events (default: the scene's)");
    add_choice_options(c, o, r);
    add_lights(c, o);
}

}  // namespace covtrace::cli
