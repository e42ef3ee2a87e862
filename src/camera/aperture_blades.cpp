#include "camera/aperture_blades.h"

#include <algorithm>
#include <cmath>

#include "core/warp.h"

namespace covtrace {

namespace {

/// A point of the polygon, from a triangle between its middle and two of its corners.
Vec2 polygon_point(const ApertureBlades& blades, Vec2 u) {
    const auto corners = static_cast<float>(blades.count);
    const float corner = std::min(std::floor(u.x * corners), corners - 1);
    const float half = kPi / corners;
    const float outward = std::sqrt(u.x * corners - corner), aside = (2 * u.y - 1) * outward;
    const Vec2 p{outward * std::cos(half), aside * std::sin(half)};
    const float turn = blades.rotation + corner * 2 * half;
    const float c = std::cos(turn), s = std::sin(turn);
    return {c * p.x - s * p.y, s * p.x + c * p.y};
}

}  // namespace

Vec2 aperture_point(const ApertureBlades& blades, Vec2 u) {
    Vec2 p = blades.count > 0 ? polygon_point(blades, u) : square_to_disc(u);
    p.x /= blades.ratio;
    return p;
}

float radius_of_like_disc(const ApertureBlades& blades) {
    // A polygon's points have the variance (2 + cos(2 pi / n)) / 12 along both axes, a disc's 1/4.
    const float round =
        blades.count > 0 ? std::sqrt((2 + std::cos(2 * kPi / float(blades.count))) / 3) : 1.0f;
    return round * std::sqrt((1 + 1 / sqr(blades.ratio)) / 2);
}

}  // namespace covtrace
