#include "render/camera_override.h"

#include <sstream>

#include "core/error.h"
#include "scene/up_axis.h"

namespace covtrace {

namespace {

std::string text(Vec3 v) {
    std::ostringstream out;
    out.precision(9);
    out << v.x << ',' << v.y << ',' << v.z;
    return out.str();
}

}  // namespace

void override_camera(const CameraOverride& camera, SceneDescription& scene) {
    const Vec3 up = camera.up.value_or(up_axis(scene));
    const auto world_to_camera = Transform::look_at(camera.eye, camera.target, up);
    if (!world_to_camera || !is_finite(camera.target - camera.eye))
        throw Error(ErrorKind::usage, OptionName{"camera"},
                    "no direction of view follows from eye " + text(camera.eye) + ", target " +
                        text(camera.target) + " and up " + text(up) +
                        "; expected another eye, target or up");
    const CameraDescription& old = scene.camera;
    const bool is_mirrored = old.camera_to_world.start().swaps_handedness();
    CameraDescription c;
    c.camera_to_world = AnimatedTransform(world_to_camera->inverse() *
                                          Transform::scale(is_mirrored ? -1 : 1, 1, 1));
    c.fov = camera.fov;
    c.focal_distance = distance(camera.eye, camera.target);
    c.shutter_open = old.shutter_open;
    c.shutter_close = old.shutter_close;
    c.medium = old.medium;
    scene.camera = c;
    // The direction that is up must not change with the direction of view.
    scene.up = nearest_axis(up);
    scene.no_camera.reset();
    std::ostringstream description;
    description.precision(9);
    description << "eye " << text(camera.eye) << " target " << text(camera.target) << " fov "
                << camera.fov << " up " << text(up);
    scene.camera_override = description.str();
}

}  // namespace covtrace
