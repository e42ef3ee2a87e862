#include "shading/strand.h"

#include <cmath>

#include "core/fast_math.h"

namespace covtrace {

// The tube's cross section is a regular polygon of n corners at the distance 1. In it `normal`
// points away from the side that was hit, `around` along it to where v grows. The outlines are the
// corners that lie farthest towards `across` and away from it.
float place_across(const SurfaceHit& hit, int sides, Vec3 wo) {
    const Vec3 axis = normalize(hit.dpdu), normal = face_forward(hit.ng, wo);
    Vec3 around = cross(normal, axis);
    if (dot(around, hit.dpdv) < 0) around = -around;
    const Vec3 across = cross(wo, axis);
    const float x = dot(across, normal), y = dot(across, around), size = std::sqrt(x * x + y * y);
    if (!(size > 0)) return 0;  // seen along the strand
    // Find the place on the side, and how far it lies across
    const auto n = static_cast<float>(sides);
    const float half = kPi / n;  // of the angle that a side takes
    const float v = hit.uv.y * n, along = v - std::floor(v);
    const SinCos corner = sin_cos(half);
    const float place = (corner.cos * x + (2 * along - 1) * corner.sin * y) / size;
    // Find the outlines: the angle to the nearest corner, from `across` and from its opposite
    const auto farthest = [&](float angle) {
        const float from_corner = angle - half;
        return sin_cos(from_corner - 2 * half * std::floor(from_corner / (2 * half) + 0.5f)).cos;
    };
    const float angle = arctangent(y, x);
    const float last = farthest(angle), first = -farthest(angle + kPi);
    return std::clamp(2 * (place - first) / (last - first) - 1, -1.0f, 1.0f);
}

}  // namespace covtrace
