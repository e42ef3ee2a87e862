#include "scene/defaults.h"

#include "scene/framing.h"
#include "scene/imaging_scale.h"
#include "scene/up_axis.h"
#include "scene/view_text.h"

namespace covtrace {

namespace {

/// Light of the sky on a surface that faces the key light, as a share of all that it gets there.
constexpr float kSky = 0.4f;
/// The sky is dark below and brightest at the horizon, so that metal shows its shape and stands out
/// from what is behind it. A floor gets as much light as from an even sky of 1, a wall nearly.
constexpr HeightGradient kGradient{0.25f, 1.3f, 0.85f};
/// Degrees across the key light: mirrors show it, and the borders of shadows are soft.
constexpr float kKeyAngle = 10;

}  // namespace

void add_default_lights(SceneDescription& scene, const SourceLocation& where) {
    const float scale = imaging_scale(scene);
    const float white = scale > 0 ? 1 / scale : 1;
    InfiniteLight sky;
    sky.radiance = Rgb(kSky * white);
    sky.gradient = kGradient;
    scene.lights.push_back({sky, upright_light(scene), where});
    DistantLight key;
    key.radiance = Rgb((1 - kSky) * kPi * white);
    const Transform& camera_to_world = scene.camera.camera_to_world.start();
    key.direction = normalize(camera_to_world.vector(normalize(Vec3{-0.5f, 0.7f, -0.6f})));
    key.angle = kKeyAngle;
    scene.lights.push_back({key, {}, where});
    scene.is_lit_from_outside = true;
    // The power follows from the view, and would change from frame to frame. In a medium the light
    // beside a lamp at the eye has no bound
    if (!scene.swept.empty() || scene.camera.medium >= 0) return;
    LampDescription lamp;
    lamp.is_for_the_dark = true;
    scene.lamps.push_back(lamp);
}

void complete(SceneDescription& scene) {
    if (scene.shapes.empty() && scene.instances.empty() && scene.camera.medium < 0)
        scene.warnings.push_back(
            {{}, "the scene has no shapes; nothing but light from all around is to be seen"});
    if (scene.no_lights) add_default_lights(scene, scene.no_lights->where);
    if (is_framed(scene)) scene.no_camera->text += ": " + view_text(scene);
    for (std::optional<Warning>* missing : {&scene.no_camera, &scene.no_lights}) {
        if (*missing) scene.warnings.push_back(**missing);
        missing->reset();
    }
}

}  // namespace covtrace
