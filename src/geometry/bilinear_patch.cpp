#include "geometry/bilinear_patch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/rounding.h"

namespace covtrace {

namespace {

double largest(Vec3d v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

bool is_parallelogram(const BilinearPatch& p) {
    const double coordinate =
        std::max({largest(p.p00), largest(p.p10), largest(p.p01), largest(p.p11)});
    return largest(p.twist()) <= 8 * kHalfUlp * coordinate;
}

bool intersect_patch(const BilinearPatch& patch, Vec3d origin, Vec3d direction, double t_min,
                     double t_max, PatchHit& hit) {
    const Vec3d q00 = patch.p00 - origin, q10 = patch.p10 - origin;
    const Vec3d q01 = patch.p01 - origin, q11 = patch.p11 - origin;
    // The line through q(u, 0) and q(u, 1) meets the ray where det(q(u, 0), d, q(u, 1)) = 0.
    const double c = dot(cross(q00, direction), q01 - q00);
    const double end = dot(cross(q10, direction), q11 - q10);
    const double a = dot(cross(q10 - q00, q01 - q11), direction);
    const double b = end - (a + c);
    double roots[2];
    int count = 0;
    const double discriminant = b * b - 4 * a * c;
    if (discriminant < 0) return false;
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    if (a != 0) roots[count++] = q / a;
    if (q != 0) roots[count++] = c / q;

    bool found = false;
    for (int i = 0; i < count; ++i) {
        const double u = roots[i];
        if (!(u >= 0 && u <= 1)) continue;
        const Vec3d start = q00 * (1 - u) + q10 * u;
        const Vec3d line = (q01 * (1 - u) + q11 * u) - start;
        const Vec3d normal = cross(direction, line);
        const double n2 = dot(normal, normal);
        if (!(n2 > 0)) continue;
        const double v = dot(cross(start, direction), normal) / n2;
        const double t = dot(cross(start, line), normal) / n2;
        if (!(v >= 0 && v <= 1) || !(t > t_min && t < t_max)) continue;
        t_max = t;
        hit = {t, u, v};
        found = true;
    }
    return found;
}

}  // namespace covtrace
