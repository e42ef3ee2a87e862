/// Fresnel reflectance of unpolarised light at a smooth border between two media.
#pragma once

#include <cmath>

#include "core/vec.h"

namespace covtrace {

struct DielectricFresnel {
    float reflectance = 1;
    float cos_t = 0;  ///< cosine of the refracted direction, >= 0; 0 where reflection is total
};

/// Mean reflectance of both polarisations from the cosines on both sides, for any scalar type.
template <typename S>
S dielectric_reflectance(const S& cos_i, const S& cos_t, float eta) {
    const S parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    const S perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

/// Reflection at a dielectric border. `cos_i` in [0, 1]; `eta`: index on the far side over the
/// index on the incident side, > 0.
inline DielectricFresnel fresnel_dielectric(float cos_i, float eta) {
    cos_i = clamp01(cos_i);
    if (eta == 1) return {0, cos_i};  // no border at all, not even by rounding
    const float sin2_t = (1 - cos_i * cos_i) / (eta * eta);
    if (sin2_t >= 1) return {};
    const float cos_t = std::sqrt(1 - sin2_t);
    return {dielectric_reflectance(cos_i, cos_t, eta), cos_t};
}

/// Reflectance of the border to a medium with the complex index eta + i k, relative to the incident
/// side; `cos_i` in [0, 1], of any scalar type. It is the mean of the squared moduli of the complex
/// amplitudes, written out in real numbers: with a + i b = sqrt((eta + i k)^2 - sin^2), |a + i b|^2
/// = sqrt((eta^2 - k^2 - sin^2)^2 + 4 eta^2 k^2).
template <typename S>
S conductor_reflectance(const S& cos_i, float eta, float k) {
    using std::sqrt;
    // Least value of a quotient's sides: where the indices match, both vanish at grazing incidence.
    constexpr float kTiny = 1e-30f;
    const auto above_zero = [](const S& x) { return x > kTiny ? x : S(kTiny); };
    const S cos2 = cos_i * cos_i, sin2 = 1 - cos2;
    const S real = eta * eta - k * k - sin2;
    const S modulus2 = sqrt(real * real + 4 * eta * eta * k * k);
    const S a2 = 0.5f * (modulus2 + real);
    const S a = a2 > 0.0f ? sqrt(a2) : S(0.0f);
    const S s_sum = modulus2 + cos2, s_cross = 2 * a * cos_i;
    const S perpendicular = (s_sum - s_cross) / above_zero(s_sum + s_cross);
    const S p_sum = modulus2 * cos2 + sin2 * sin2, p_cross = s_cross * sin2;
    const S parallel = perpendicular * (p_sum - p_cross) / above_zero(p_sum + p_cross);
    return 0.5f * (perpendicular + parallel);
}
inline float fresnel_conductor(float cos_i, float eta, float k) {
    return conductor_reflectance(clamp01(cos_i), eta, k);
}
inline Rgb fresnel_conductor(float cos_i, Rgb eta, Rgb k) {
    return {fresnel_conductor(cos_i, eta.r, k.r), fresnel_conductor(cos_i, eta.g, k.g),
            fresnel_conductor(cos_i, eta.b, k.b)};
}

}  // namespace covtrace
