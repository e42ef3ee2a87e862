#include "light/spot_cone.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

namespace {

float radians(float degrees) {
    return degrees * (kPi / 180);
}

float smoothstep(float x) {
    x = clamp01(x);
    return x * x * (3 - 2 * x);
}

/// Tangent of the angle with a cosine > 0.
float tangent(float cosine) {
    return safe_sqrt(1 - sqr(cosine)) / cosine;
}

}  // namespace

SpotCone SpotCone::from_degrees(float angle, float delta_angle) {
    const float outer = std::clamp(angle, 0.0f, 180.0f);
    // pbrt-v4 takes the cosine of the difference, so the sign of a negative one does not count.
    const float inner = std::clamp(std::abs(angle - delta_angle), 0.0f, outer);
    return {std::cos(radians(inner)), std::cos(radians(outer))};
}

SpotCone SpotCone::grid(float angle) {
    constexpr float kLeastCosine = 1e-6f;  // whose tangent is finite, and no light's
    return {1, std::max(std::cos(radians(std::clamp(angle, 0.0f, 90.0f))), kLeastCosine), true};
}

float SpotCone::falloff(float cosine) const {
    if (is_grid) {
        if (cosine <= cos_outer) return 0;
        return 1 - tangent(std::min(cosine, 1.0f)) / tangent(cos_outer);
    }
    if (cosine >= cos_inner) return 1;
    if (cosine <= cos_outer) return 0;
    return smoothstep((cosine - cos_outer) / (cos_inner - cos_outer));
}

float SpotCone::solid_angle() const {
    if (is_grid) {
        // Integral of sin (1 - tan / tan(outer)) over the angle, in closed form
        const double c = cos_outer, s = std::sqrt(1 - c * c);
        return static_cast<float>(2 * M_PI * ((1 - c) - c / s * (std::log((1 + s) / c) - s)));
    }
    // A smoothstep in the cosine lets half of its range through
    return 2 * kPi * ((1 - cos_inner) + (cos_inner - cos_outer) / 2);
}

float SpotCone::variance() const {
    // Half the mean squared angle to the axis over the solid angle of the cone, weighted by the
    // intensity. Steps of equal cosine have equal solid angles; 256 of them leave a relative error
    // below 1e-4.
    constexpr int kSteps = 256;
    double weight = 0, square = 0;
    for (int i = 0; i < kSteps; ++i) {
        const float cosine = 1 - (1 - cos_outer) * (float(i) + 0.5f) / kSteps;
        const double angle = std::acos(cosine), f = falloff(cosine);
        weight += f;
        square += f * angle * angle;
    }
    return weight > 0 ? static_cast<float>(0.5 * square / weight) : 0.0f;
}

}  // namespace covtrace
