#include "scene/view_text.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "scene/extent.h"
#include "scene/up_axis.h"

namespace covtrace {

namespace {

/// Rounds to a power of ten.
std::string rounded(Vec3 v, double unit) {
    std::ostringstream out;
    out.precision(9);
    for (int i = 0; i < 3; ++i)
        out << (i > 0 ? "," : "") << std::round(double(v[i]) / unit) * unit + 0.0;
    return out.str();
}

}  // namespace

std::string view_text(const SceneDescription& scene) {
    const CameraDescription& camera = scene.camera;
    const Transform& to_world = camera.camera_to_world.start();
    const Vec3 eye = to_world.point({}), forward = normalize(to_world.vector({0, 0, 1}));
    const Bounds3 box = bounds(scene);
    const float radius = box.empty() ? 1 : box.radius();
    const float to_middle = box.empty() ? 1 : dot(box.center() - eye, forward);
    float way = camera.focal_distance;
    if (!(way > 0 && way < std::abs(to_middle) + 2 * radius)) way = to_middle;
    if (!(way > 1e-3f * radius)) way = std::max(radius, 1e-6f);
    const double unit = std::pow(10.0, std::floor(std::log10(double(way))) - 4);
    std::ostringstream out;
    out << "eye " << rounded(eye, unit) << " target " << rounded(eye + forward * way, unit);
    if (camera.kind == CameraDescription::Kind::perspective) out << " fov " << camera.fov;
    const Vec3 top = to_world.vector({0, 1, 0}), up = up_axis(scene);
    const Vec3 upright = up - forward * dot(up, forward);
    if (dot(normalize(top), normalize(upright)) < 0.9999f)
        out << " up " << rounded(normalize(top), 1e-4);
    return out.str();
}

}  // namespace covtrace
