#include "shading/medium.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

namespace {

float pass(float coefficient, float distance) {
    return coefficient > 0 ? std::exp(-coefficient * distance) : 1.0f;
}

float sum(Rgb c) {
    return c.r + c.g + c.b;
}

/// Part of what scatters at all that is placed by the angle at a light.
constexpr float kMostByAngle = 0.5f;

/// Distances along a ray that are even in the angle at a light. The angle is measured from the
/// ray's origin on: as a difference of two from the nearest point it would be lost in roundings
/// where a light far away lies in the direction of the ray.
class EvenAngles {
  public:
    EvenAngles(const LightBeside& light, float length)
        : along_(double(light.along)),
          away_(double(light.away)),
          squared_(along_ * along_ + away_ * away_),
          length_(length),
          span_(std::atan2(double(length) * away_, squared_ - along_ * double(length))) {}
    bool is_empty() const { return !(span_ > 0); }
    float sample(float u) const {
        const double angle = double(u) * span_, sine = std::sin(angle), cosine = std::cos(angle);
        const double distance = sine * squared_ / (away_ * cosine + along_ * sine);
        return std::clamp(float(distance), 0.0f, length_);
    }
    float density(float distance) const {
        const double from_nearest = double(distance) - along_;
        return float(away_ / (span_ * (away_ * away_ + from_nearest * from_nearest)));
    }

  private:
    double along_, away_, squared_;  ///< the last one of the distance from the origin to the light
    float length_;
    double span_;
};

}  // namespace

Rgb Medium::albedo() const {
    const Rgb t = extinction();
    const auto share = [](float part, float whole) { return whole > 0 ? part / whole : 0.0f; };
    return {share(scattering.r, t.r), share(scattering.g, t.g), share(scattering.b, t.b)};
}

Rgb transmittance(const Medium& medium, float distance) {
    const Rgb s = medium.extinction();
    return {pass(s.r, distance), pass(s.g, distance), pass(s.b, distance)};
}

Rgb emitted_along(const Medium& medium, float distance) {
    Rgb sum;
    const Rgb extinction = medium.extinction();
    for (int c = 0; c < 3; ++c) {
        if (!(medium.absorption[c] > 0 && medium.emission[c] > 0)) continue;
        sum[c] = medium.absorption[c] / extinction[c] * medium.emission[c] *
                 -std::expm1(-extinction[c] * distance);
    }
    return sum;
}

MediumEvent sample_event(const Medium& medium, float length, Rgb throughput, Vec2 u,
                         const std::optional<LightBeside>& light) {
    const Rgb through = transmittance(medium, length);
    const float all = sum(throughput);
    if (!medium.scatters() || !(all > 0)) return {false, length, through};

    const Rgb share = throughput * (1 / all), extinction = medium.extinction(),
              albedo = medium.albedo();
    // Find the part that is placed by the angle at the light
    std::optional<EvenAngles> angles;
    float by_angle = 0;
    if (light && std::isfinite(length)) {
        angles.emplace(*light, length);
        const float nearest = std::clamp(light->along, 0.0f, length);
        if (!angles->is_empty())
            by_angle = kMostByAngle * light->share * sum(share * albedo * (Rgb(1) - through)) *
                       sum(share * transmittance(medium, nearest));
    }
    const float by_distance = 1 - by_angle;
    const auto scatter = [&](float distance) -> MediumEvent {
        const Rgb value = medium.scattering * transmittance(medium, distance);
        float density = by_distance * sum(share * value);
        if (by_angle > 0) density += by_angle * angles->density(distance);
        return {true, distance, density > 0 ? value * (1 / density) : Rgb(0)};
    };
    if (u.x < by_angle) return scatter(angles->sample(u.y));
    // Draw the rest by a channel's exponential
    float v = (u.x - by_angle) / by_distance;
    int channel = 0;
    while (channel < 2 && v >= share[channel]) v -= share[channel++];
    const bool tries = v < albedo[channel] * share[channel];  // rather than be absorbed
    const float distance = tries ? -std::log1p(-u.y) / extinction[channel] : length;
    if (tries && distance < length) return scatter(distance);
    const float probability = by_distance * sum(share * (Rgb(1) - albedo * (Rgb(1) - through)));
    return {false, length, probability > 0 ? through * (1 / probability) : Rgb(0)};
}

}  // namespace covtrace
