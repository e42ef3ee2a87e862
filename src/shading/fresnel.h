/// Fresnel reflectance of unpolarised light at a smooth border between two media.
#pragma once

#include <cmath>

#include "core/vec.h"

namespace covtrace {

struct DielectricFresnel {
    float reflectance = 1;
    float cos_t = 0;  ///< cosine of the refracted direction, >= 0; 0 where reflection is total
};

/// `cos_i` in [0, 1]; `eta`: index on the far side over the index on the incident side, > 0.
inline DielectricFresnel fresnel_dielectric(float cos_i, float eta) {
    cos_i = clamp01(cos_i);
    if (eta == 1) return {0, cos_i};  // no border at all, not even by rounding
    const float sin2_t = (1 - cos_i * cos_i) / (eta * eta);
    if (sin2_t >= 1) return {};
    const float cos_t = std::sqrt(1 - sin2_t);
    const float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    const float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return {0.5f * (sqr(parallel) + sqr(perpendicular)), cos_t};
}

/// Border to a medium with the complex index eta + i k, relative to the incident side; `cos_i` in
/// [0, 1]. The squared moduli of the complex amplitudes, written out in real numbers: with a + i b
/// = sqrt((eta + i k)^2 - sin^2), |a + i b|^2 = sqrt((eta^2 - k^2 - sin^2)^2 + 4 eta^2 k^2).
inline float fresnel_conductor(float cos_i, float eta, float k) {
    // Where the indices match, both sides of a quotient vanish at grazing incidence.
    constexpr float kTiny = 1e-30f;
    cos_i = clamp01(cos_i);
    const float cos2 = cos_i * cos_i, sin2 = 1 - cos2;
    const float real = eta * eta - k * k - sin2;
    const float modulus2 = std::sqrt(real * real + 4 * eta * eta * k * k);
    const float a = safe_sqrt(0.5f * (modulus2 + real));
    const float s_sum = modulus2 + cos2, s_cross = 2 * a * cos_i;
    const float perpendicular = (s_sum - s_cross) / std::max(s_sum + s_cross, kTiny);
    const float p_sum = modulus2 * cos2 + sin2 * sin2, p_cross = s_cross * sin2;
    const float parallel = perpendicular * (p_sum - p_cross) / std::max(p_sum + p_cross, kTiny);
    return 0.5f * (perpendicular + parallel);
}
inline Rgb fresnel_conductor(float cos_i, Rgb eta, Rgb k) {
    return {fresnel_conductor(cos_i, eta.r, k.r), fresnel_conductor(cos_i, eta.g, k.g),
            fresnel_conductor(cos_i, eta.b, k.b)};
}

}  // namespace covtrace
