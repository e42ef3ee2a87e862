#include "light/environment.h"

#include <cmath>

#include "core/fast_math.h"
#include "core/parallel.h"
#include "core/warp.h"
#include "light/delta.h"
#include "light/weight.h"

namespace covtrace {

namespace {

constexpr int kWidestSpectrum = 1024;
constexpr int kMostTapsPerAxis = 4;

Vec3 from_angles(float theta, float phi) {
    const float s = std::sin(theta);
    return {s * std::cos(phi), s * std::sin(phi), std::cos(theta)};
}

bool preserves_lengths(const Transform& t) {
    const Vec3 x = t.vector({1, 0, 0}), y = t.vector({0, 1, 0}), z = t.vector({0, 0, 1});
    const auto is = [](float value, float expected) { return std::abs(value - expected) < 1e-5f; };
    return is(dot(x, x), 1) && is(dot(y, y), 1) && is(dot(z, z), 1) && is(dot(x, y), 0) &&
           is(dot(y, z), 0) && is(dot(z, x), 0);
}

}  // namespace

Environment::Environment(const InfiniteLight& light, const Transform& light_to_world,
                         const SourceLocation& where, Warnings& warnings)
    : light_to_world_(light_to_world),
      to_world_(linear(light_to_world)),
      to_light_(linear(light_to_world.inverse())),
      is_rigid_(preserves_lengths(light_to_world)),
      scale_(light.radiance) {
    determinant_ = std::abs(dot(cross(to_light_.x, to_light_.y), to_light_.z));
    if (light.image) map_ = EnvironmentMap::read(*light.image, where, warnings);
    if (light.illuminance) {
        const Rgb measured = scale_ * (map_ ? map_->irradiance_from_above() : Rgb(kPi));
        scale_ *= normalisation(*light.illuminance, luminance(measured));
    }
}

Environment::Linear Environment::linear(const Transform& t) {
    return {t.vector({1, 0, 0}), t.vector({0, 1, 0}), t.vector({0, 0, 1})};
}

Vec3 Environment::direction(Vec3 n, const EnvironmentMap::Draw& draw) const {
    if (map_) return normalize(to_world_(map_->direction(draw)));
    if (n == Vec3{}) return square_to_sphere(draw.u);
    return normalize(Frame::from_z(n).to_world(square_to_cosine_hemisphere(draw.u)));
}

EnvironmentMap::Sight Environment::look(Vec3 n, Vec3 w) const {
    if (!map_) return {scale_, n == Vec3{} ? kUniformSpherePdf : cosine_hemisphere_pdf(dot(n, w))};
    Vec3 local = to_light_(w);
    float stretch = 1;
    if (!is_rigid_) {
        const float l = length(local);
        local = local / l;
        stretch = determinant_ / (l * l * l);
    }
    EnvironmentMap::Sight sight = map_->look(local);
    sight.radiance *= scale_;
    sight.pdf *= stretch;
    return sight;
}

Rgb Environment::mean_radiance() const {
    return map_ ? scale_ * map_->mean() : scale_;
}

float Environment::irradiance() const {
    return kPi * choice_weight(mean_radiance()) * (map_ ? map_->drawn_share() : 1.0f);
}

void Environment::prepare_spectrum() {
    if (!map_ || spectrum_) return;
    // A square map is analysed as a lat-long map with as many texels.
    const int full = map_->layout() == EnvironmentMap::Layout::lat_long
                         ? map_->width()
                         : int(std::ceil(std::sqrt(2.0f) * float(map_->width())));
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
                    sum += luminance(scale_ * map_->radiance(from_angles(kPi * t, 2 * kPi * s)));
                }
            values[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)] =
                sum / float(taps * taps);
        }
    });
    spectrum_.emplace(values, width, height, ImageSpectrum::Wrap::repeat_s);
    // The two rows next to a pole share one factor: there the map's rows shrink to a point.
    pole_sine_ = std::sin(std::min(2 * kPi / float(height), kPi / 2));
    is_mirrored_ = light_to_world_.swaps_handedness();
}

AngularCovariance Environment::spectrum(Vec3 w) const {
    AngularCovariance a;
    if (!spectrum_) {
        a.tangent = Frame::from_z(-w);
        return a;
    }
    const Vec3 local = normalize(to_light_(w));
    const float horizontal = std::sqrt(local.x * local.x + local.y * local.y);
    const float theta = arctangent(horizontal, local.z);
    float phi = arctangent(local.y, local.x);
    if (phi < 0) phi += 2 * kPi;
    const float inverse = 1 / horizontal;
    const float cos_phi = horizontal > 0 ? local.x * inverse : 1,
                sin_phi = horizontal > 0 ? local.y * inverse : 0;
    a.tangent = Frame::from_z_x(-w, light_to_world_.vector({-sin_phi, cos_phi, 0}));

    const float sine = std::max(horizontal, pole_sine_);
    const float s_per_radian = 1 / (2 * kPi * sine), t_per_radian = 1 / kPi;
    const SpatialCovariance2 c = spectrum_->at(phi / (2 * kPi), theta / kPi);
    a.a11 = c.ss * s_per_radian * s_per_radian;
    a.a12 = c.st * s_per_radian * t_per_radian * (is_mirrored_ ? -1.0f : 1.0f);
    a.a22 = c.tt * t_per_radian * t_per_radian;
    return a;
}

}  // namespace covtrace
