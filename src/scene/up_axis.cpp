#include "scene/up_axis.h"

#include <cmath>

namespace covtrace {

Vec3 nearest_axis(Vec3 direction) {
    int nearest = 1;  // the y axis, where nothing is nearer
    for (const int axis : {2, 0})
        if (std::abs(direction[axis]) > std::abs(direction[nearest])) nearest = axis;
    Vec3 axis;
    axis[nearest] = direction[nearest] < 0 ? -1.0f : 1.0f;
    return axis;
}

Vec3 up_axis(const SceneDescription& scene) {
    return scene.up.value_or(nearest_axis(scene.camera.camera_to_world.start().vector({0, 1, 0})));
}

}  // namespace covtrace
