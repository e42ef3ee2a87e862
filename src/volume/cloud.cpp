#include "volume/cloud.h"

#include <algorithm>
#include <cmath>

#include "core/noise.h"
#include "core/parallel.h"

namespace covtrace {

namespace {

/// The slope of noise, by differences over a hundredth as pbrt-v4 has it.
Vec3 noise_slope(Vec3 p) {
    constexpr float kStep = 0.01f;
    const float here = noise(p);
    return (Vec3{noise(p + Vec3{kStep, 0, 0}), noise(p + Vec3{0, kStep, 0}),
                 noise(p + Vec3{0, 0, kStep})} -
            Vec3{here, here, here}) /
           kStep;
}

}  // namespace

float Cloud::at(Vec3 p) const {
    Vec3 bent = frequency * p;
    if (wispiness > 0) {
        float strength = 0.05f * wispiness, fineness = 10;
        for (int i = 0; i < 2; ++i) {
            bent = bent + strength * noise_slope(fineness * bent);
            strength *= 0.5f;
            fineness *= 1.99f;
        }
    }
    const float shape = 0.5f * fractal_noise(bent, 0, {5, 0.5f}), height = 1 - p.y;
    return clamp01(clamp01(height * 4.5f * density * shape) + 2 * std::max(0.0f, 0.5f - p.y));
}

DensityGrid cloud_grid(const Cloud& cloud, const Transform& cloud_from_world,
                       const SourceLocation& where) {
    // Five octaves, each 1.99 times as fast as the one before: three cells for a period of the last
    constexpr float kCellsPerPeriod = 3, kFastest = 15.7f, kFewest = 16, kMost = 192;
    const Vec3 side = cloud.bounds.diagonal();
    const float longest = std::max({side.x, side.y, side.z});
    const float cells =
        std::clamp(kCellsPerPeriod * kFastest * cloud.frequency * longest, kFewest, kMost);
    LatticePlace n;
    for (int a = 0; a < 3; ++a) n[size_t(a)] = 1 + int(std::ceil(cells * side[a] / longest));
    const auto place = [&](float x, float y, float z) {
        return cloud.bounds.lo + Vec3{side.x * x / float(n[0] - 1), side.y * y / float(n[1] - 1),
                                      side.z * z / float(n[2] - 1)};
    };
    const size_t count = size_t(n[0]) * size_t(n[1]) * size_t(n[2]);
    std::vector<float> values(count);
    parallel_for_rows(n[1], n[2], [&](int z) {
        float* value = values.data() + size_t(n[0]) * size_t(n[1]) * size_t(z);
        for (int y = 0; y < n[1]; ++y)
            for (int x = 0; x < n[0]; ++x) *value++ = cloud.at(place(float(x), float(y), float(z)));
    });
    const Transform lattice_from_cloud =
        Transform::scale(float(n[0] - 1) / side.x, float(n[1] - 1) / side.y,
                         float(n[2] - 1) / side.z) *
        Transform::translate(-cloud.bounds.lo);
    const Vec3 end{float(n[0] - 1), float(n[1] - 1), float(n[2] - 1)};
    const auto value = [&](const LatticePlace& at) {
        return values[size_t(at[0]) +
                      size_t(n[0]) * (size_t(at[1]) + size_t(n[1]) * size_t(at[2]))];
    };
    return {lattice_from_cloud * cloud_from_world, Bounds3{{0, 0, 0}, end},
            Lattice{{}, {n[0] - 1, n[1] - 1, n[2] - 1}, value}, where};
}

}  // namespace covtrace
