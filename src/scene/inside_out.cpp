#include "scene/inside_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace covtrace {
namespace {

/// Signed solid angle of the triangle with these corners relative to the point that sees it,
/// positive where it shows its back (Van Oosterom and Strackee 1983, "The solid angle of a plane
/// triangle").
double solid_angle(Vec3 a, Vec3 b, Vec3 c) {
    const double la = length(a), lb = length(b), lc = length(c);
    return 2 * std::atan2(double(dot(a, cross(b, c))), la * lb * lc + double(dot(a, b)) * lc +
                                                           double(dot(b, c)) * la +
                                                           double(dot(c, a)) * lb);
}

/// Mean over the surface of the mesh's winding number just before its fronts: -1 where it encloses
/// them all around, 0 where it encloses what is behind them, near -0.5 before open sheets.
double winding_before_fronts(const TriangleMesh& mesh, float diagonal) {
    std::vector<double> sums;  // of the areas up to each triangle
    double areas = 0;
    const auto corners = [&](size_t i) {
        const auto& t = mesh.triangles[i];
        return std::array{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    };
    const auto normal = [&](size_t i) {
        const auto [a, b, c] = corners(i);
        return cross(b - a, c - a);
    };
    for (size_t i = 0; i < mesh.triangles.size(); ++i)
        sums.push_back(areas += double(length(normal(i))));
    constexpr int kProbes = 32;
    constexpr float kBefore = 1e-4f;  // of the diagonal
    double total = 0;
    for (int probe = 0; probe < kProbes; ++probe) {
        const auto found = std::ranges::lower_bound(sums, (probe + 0.5) / kProbes * areas);
        const auto at = static_cast<size_t>(found - sums.begin());
        const auto [a, b, c] = corners(at);
        const Vec3 point = (a + b + c) / 3 + kBefore * diagonal * normalize(normal(at));
        for (size_t i = 0; i < mesh.triangles.size(); ++i) {
            const auto [p, q, r] = corners(i);
            total += solid_angle(p - point, q - point, r - point);
        }
    }
    return total / (4 * M_PI * kProbes);
}

}  // namespace

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
    if (open >= kMostOpen * areas || volume >= -kLeastVolume * volumes) return false;
    // Open sheets, as the undersides of a chair's seat and back in one mesh, may have all that and
    // enclose nothing. A box that lacks a side has -0.9, a bowl -0.8, those sheets -0.2.
    constexpr double kEnclosed = -0.7;
    return winding_before_fronts(mesh, length(box.diagonal())) < kEnclosed;
}

}  // namespace covtrace
