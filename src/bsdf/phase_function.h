/// Phase function of Henyey and Greenstein 1941, "Diffuse radiation in the galaxy": how light
/// changes its direction in a medium.
///
///     p(c) = (1 - g^2) / (4 pi (1 + g^2 - 2 g c)^(3/2)),   c = cosine of the change of direction
///
/// It is its own density per solid angle, so that sampling it weighs every direction the same.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/frame.h"

namespace covtrace {

/// Value of the phase function for a change of direction of cosine `c`; `g` in (-1, 1) is the mean
/// cosine, positive for light that goes on forwards. Integrates to 1 over the sphere.
inline float henyey_greenstein(float g, float c) {
    const float d = 1 + g * g - 2 * g * c;
    return kInvPi / 4 * (1 - g * g) / (d * std::sqrt(std::max(d, 1e-12f)));
}

/// Cosine of the change of direction for `u` in [0, 1): the inverse distribution function, written
/// without the difference that cancels for small g.
inline float sample_henyey_greenstein(float g, float u) {
    const double k = g, s = 2 * double(u) - 1, d = 1 + k * s;
    const double n = s + k * (3 + s * s) / 2 + k * k * s + k * k * k * (s * s - 1) / 2;
    return static_cast<float>(std::clamp(n / (d * d), -1.0, 1.0));
}

/// A direction (unit, away from the point, as `wo` is) with density henyey_greenstein(g, -dot(wo,
/// wi)).
inline Vec3 sample_phase(float g, Vec3 wo, Vec2 u) {
    const float c = sample_henyey_greenstein(g, u.x), s = safe_sqrt(1 - c * c), phi = 2 * kPi * u.y;
    return Frame::from_z(-wo).to_world({s * std::cos(phi), s * std::sin(phi), c});
}

}  // namespace covtrace
