#include "scene/inside_out.h"

#include <array>
#include <cmath>

namespace covtrace {

bool is_inside_out(const TriangleMesh& mesh) {
    // A closed surface has no area in the mean, and a volume that is negative inside out; shells
    // around what stands on the ground lack a sixth. Cards of two triangles back to back have no
    // volume beyond rounding.
    constexpr double kMostOpen = 0.3, kLeastVolume = 0.01;
    Bounds3 box;
    for (const Vec3& p : mesh.positions) box.extend(p);
    const Vec3 middle = box.center();
    std::array<double, 3> sum{};
    double areas = 0, volume = 0, volumes = 0;
    for (const auto& t : mesh.triangles) {
        const Vec3 a = mesh.positions[t[0]] - middle, b = mesh.positions[t[1]] - middle;
        const Vec3 c = mesh.positions[t[2]] - middle;
        const Vec3 n = cross(b - a, c - a);
        for (int i = 0; i < 3; ++i) sum[static_cast<size_t>(i)] += double(n[i]);
        areas += double(length(n));
        volume += double(dot(a, n));
        volumes += std::abs(double(dot(a, n)));
    }
    const double open = std::hypot(sum[0], sum[1], sum[2]);
    return open < kMostOpen * areas && volume < -kLeastVolume * volumes;
}

}  // namespace covtrace
