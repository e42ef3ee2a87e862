#include "light/environment_spectrum.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/fast_math.h"
#include "core/parallel.h"

namespace covtrace {

namespace {

/// Largest width, in texels, at which a map is analysed: a texel is then a third of a degree wide.
constexpr int kWidestSpectrum = 1024;
/// Most places per axis at which a wider map is looked up for the mean over one analysed texel:
/// enough for every texel of a map that is 4096 wide.
constexpr int kMostTapsPerAxis = 4;

/// Unit direction in light space, whose pole is z, for angles in radians.
Vec3 from_angles(float theta, float phi) {
    const float s = std::sin(theta);
    return {s * std::cos(phi), s * std::sin(phi), std::cos(theta)};
}

}  // namespace

EnvironmentSpectrum::EnvironmentSpectrum(const Environment& light) : light_(&light) {
    const EnvironmentMap* map = light.map();
    if (!map) return;
    // A square map is analysed as a lat-long map with as many texels.
    const int full = map->layout() == EnvironmentMap::Layout::lat_long
                         ? map->width()
                         : int(std::ceil(std::sqrt(2.0f) * float(map->width())));
    const int width = std::min(full, kWidestSpectrum), height = std::max(1, width / 2);
    const int taps = std::clamp((full + width - 1) / width, 1, kMostTapsPerAxis);
    std::vector<float> values(static_cast<size_t>(width) * static_cast<size_t>(height));
    parallel_for(height, [&](int64_t y) {
        for (int x = 0; x < width; ++x) {
            float sum = 0;
            for (int j = 0; j < taps; ++j)
                for (int i = 0; i < taps; ++i) {
                    const float s = (float(x) + (float(i) + 0.5f) / float(taps)) / float(width);
                    const float t = (float(y) + (float(j) + 0.5f) / float(taps)) / float(height);
                    sum +=
                        luminance(light.scale() * map->radiance(from_angles(kPi * t, 2 * kPi * s)));
                }
            values[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)] =
                sum / float(taps * taps);
        }
    });
    image_.emplace(values, width, height, ImageSpectrum::Wrap::repeat_s);
    // The map's rows shrink to a point at the poles. Nearer to one than two rows, the scale along
    // the row is that of two rows away, so that it stays finite.
    pole_sine_ = std::sin(std::min(2 * kPi / float(height), kPi / 2));
    is_mirrored_ = light.light_to_world().swaps_handedness();
}

AngularCovariance EnvironmentSpectrum::at(Vec3 w) const {
    AngularCovariance a;
    if (!image_) {
        a.tangent = Frame::from_z(-w);
        // The second moments of a disc are a quarter of the square of its radius
        if (const DistantDisc* disc = light_->disc(); disc && disc->contains(w))
            a.a11 = a.a22 = 1 / sqr(kPi * disc->angular_radius());
        return a;
    }
    const Vec3 local = normalize(light_->to_light(w));
    const float horizontal = std::sqrt(local.x * local.x + local.y * local.y);
    const float theta = arctangent(horizontal, local.z);
    float phi = arctangent(local.y, local.x);
    if (phi < 0) phi += 2 * kPi;
    const float inverse = 1 / horizontal;
    const float cos_phi = horizontal > 0 ? local.x * inverse : 1,
                sin_phi = horizontal > 0 ? local.y * inverse : 0;
    a.tangent = Frame::from_z_x(-w, light_->light_to_world().vector({-sin_phi, cos_phi, 0}));

    const float sine = std::max(horizontal, pole_sine_);
    const float s_per_radian = 1 / (2 * kPi * sine), t_per_radian = 1 / kPi;
    const SpatialCovariance2 c = image_->at(phi / (2 * kPi), theta / kPi);
    a.a11 = c.ss * s_per_radian * s_per_radian;
    a.a12 = c.st * s_per_radian * t_per_radian * (is_mirrored_ ? -1.0f : 1.0f);
    a.a22 = c.tt * t_per_radian * t_per_radian;
    return a;
}

}  // namespace covtrace
