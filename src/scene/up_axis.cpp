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

Transform upright_light(const SceneDescription& scene) {
    const Vec3 up = up_axis(scene);
    const Vec3 front = up.x != 0 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    // The camera's x, y, z are right, up, forward: a left-handed frame, unless it is mirrored.
    const bool is_right_handed = scene.camera.camera_to_world.start().swaps_handedness();
    const Vec3 right = is_right_handed ? cross(front, up) : cross(up, front);
    Matrix4 m;
    for (int row = 0; row < 3; ++row) {
        m.m[size_t(row)][0] = double(-front[row]);
        m.m[size_t(row)][1] = double(-right[row]);
        m.m[size_t(row)][2] = double(up[row]);
    }
    return {m, transpose(m)};
}

}  // namespace covtrace
