#include "occluders/edge_measure.h"

#include <cmath>

namespace covtrace {

EdgeMeasure::Range EdgeMeasure::reach(float length) const {
    const Range none{1, 0};
    if (!(widest > 0) || !(length > 0)) return none;
    // The range is where (a0 + a1 z)^2 - widest^2 h(z) <= 0. In double, as both terms may be large
    // beside the difference.
    const double w2 = double(widest) * widest;
    const double a = double(a1) * a1 - w2 * h2, half_b = double(a0) * a1 - 0.5 * w2 * h1,
                 c = double(a0) * a0 - w2 * h0;
    if (a == 0 && half_b == 0) return c <= 0 ? Range{0, length} : none;
    const double discriminant = half_b * half_b - a * c;
    if (discriminant < 0) return a < 0 ? Range{0, length} : none;
    const double root = std::sqrt(discriminant);
    double lo = 0, hi = length;
    // The roots are computed in the form without cancellation.
    const double q = -(half_b + std::copysign(root, half_b));
    double z0 = a != 0 ? q / a : -c / (2 * half_b), z1 = q != 0 ? c / q : z0;
    if (a == 0) z1 = z0;
    if (z0 > z1) std::swap(z0, z1);
    if (a > 0) {
        lo = std::max(lo, z0);
        hi = std::min(hi, z1);
    } else if (a == 0) {
        if (half_b > 0)
            hi = std::min(hi, z0);
        else
            lo = std::max(lo, z0);
    } else {
        // A parabola that opens downwards: the range lies outside of the roots, [0, length] less
        // what either root cuts off an end.
        if (z0 < 0) lo = std::max(lo, std::min(z1, hi + 1));
        if (z1 > hi) hi = std::min(hi, z0);
    }
    return lo <= hi ? Range{static_cast<float>(lo), static_cast<float>(hi)} : none;
}

}  // namespace covtrace
