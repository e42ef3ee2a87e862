#include "scene/defaults.h"

#include "scene/framing.h"
#include "scene/imaging_scale.h"
#include "scene/view_text.h"

namespace covtrace {

namespace {

void add_default_lights(SceneDescription& scene, const SourceLocation& where) {
    constexpr float kSky = 0.4f;  // of the light that a surface gets which faces the key
    const float scale = imaging_scale(scene);
    const float white = scale > 0 ? 1 / scale : 1;
    LightDescription sky, key;
    sky.where = key.where = where;
    InfiniteLight uniform;
    uniform.radiance = Rgb(kSky * white);
    sky.value = uniform;
    DistantLight distant;
    distant.radiance = Rgb((1 - kSky) * kPi * white);
    const Transform& camera_to_world = scene.camera.camera_to_world.start();
    distant.direction = normalize(camera_to_world.vector(normalize(Vec3{-0.5f, 0.7f, -0.6f})));
    key.value = distant;
    scene.lights.push_back(sky);
    scene.lights.push_back(key);
}

}  // namespace

void complete(SceneDescription& scene) {
    if (scene.no_lights) add_default_lights(scene, scene.no_lights->where);
    if (is_framed(scene)) scene.no_camera->text += ": " + view_text(scene);
    for (std::optional<Warning>* missing : {&scene.no_camera, &scene.no_lights}) {
        if (*missing) scene.warnings.push_back(**missing);
        missing->reset();
    }
}

}  // namespace covtrace
