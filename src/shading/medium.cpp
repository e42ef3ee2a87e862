#include "shading/medium.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace covtrace {

namespace {

float pass(float coefficient, float column) {
    return coefficient > 0 ? std::exp(-coefficient * column) : 1.0f;
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

Rgb even_glow(const Medium& medium, float column) {
    Rgb sum;
    const Rgb extinction = medium.extinction();
    for (int c = 0; c < 3; ++c) {
        if (!(medium.absorption[c] > 0 && medium.emission[c] > 0)) continue;
        sum[c] = medium.absorption[c] / extinction[c] * medium.emission[c] *
                 -std::expm1(-extinction[c] * column);
    }
    return sum;
}

/// Columns up to `column` that are even in what reaches the start of light that is everywhere the
/// same, of the channels that absorb in the mean.
class EvenLight {
  public:
    EvenLight(const Medium& medium, float column) : column_(column) {
        const Rgb extinction = medium.extinction();
        for (int c = 0; c < 3; ++c) {
            const float whole = -std::expm1(-extinction[c] * column);
            if (medium.absorption[c] > 0 && whole > 0) channels_[count_++] = {extinction[c], whole};
        }
    }
    bool is_empty() const { return count_ == 0; }
    float density(float column) const {
        return mean([&](const Channel& c) {
            return c.extinction * std::exp(-c.extinction * column) / c.whole;
        });
    }
    /// Where the share `u` of the light comes from columns below; u in [0, 1).
    float sample(float u) const {
        // Each channel alone bounds it
        float low = column_, high = 0;
        for (size_t i = 0; i < count_; ++i) {
            const Channel& c = channels_[i];
            const float alone = std::min(-std::log1p(-u * c.whole) / c.extinction, column_);
            low = std::min(low, alone);
            high = std::max(high, alone);
        }
        float at = low;
        constexpr float kClose = 1e-6f;
        for (int i = 0; i < 24 && high - low > kClose * high; ++i) {
            const float error = share_below(at) - u;
            if (std::abs(error) <= kClose * u) break;
            (error < 0 ? low : high) = at;
            const float newton = at - error / density(at);
            at = newton > low && newton < high ? newton : 0.5f * (low + high);
        }
        return at;
    }

  private:
    struct Channel {
        float extinction, whole;  ///< the latter of what reaches the start along all of the way
    };
    template <class F>
    float mean(const F& of_channel) const {
        float sum = 0;
        for (size_t i = 0; i < count_; ++i) sum += of_channel(channels_[i]);
        return sum / float(count_);
    }
    float share_below(float column) const {
        return mean(
            [&](const Channel& c) { return -std::expm1(-c.extinction * column) / c.whole; });
    }

    float column_;
    std::array<Channel, 3> channels_{};
    size_t count_ = 0;
};

Rgb glow_along(const Medium& medium, const MediumWay& way, float column, float length, float u) {
    const EvenLight even(medium, column);
    if (even.is_empty()) return {};
    constexpr int kPlaces = 4;
    std::array<float, kPlaces> columns, distances;
    for (int i = 0; i < kPlaces; ++i) columns[size_t(i)] = even.sample((float(i) + u) / kPlaces);
    way.distances(columns, length, distances);
    Rgb light;
    for (size_t i = 0; i < kPlaces; ++i) {
        if (!(distances[i] < length)) continue;
        const float density = kPlaces * even.density(columns[i]);
        if (density > 0)
            light += medium.glow->at(way.point(distances[i])) * transmittance(medium, columns[i]) *
                     (1 / density);
    }
    return light * medium.absorption;
}

Rgb source_along(const Medium& medium, const MediumWay& way, float length, float u) {
    const EmissionField& source = *medium.source;
    const float whole = source.whole->column(way.origin(), way.direction(), length);
    if (!(whole > 0)) return {};
    constexpr int kPlaces = 4;  // as of a glow
    std::array<float, kPlaces> columns, distances;
    for (int i = 0; i < kPlaces; ++i) columns[size_t(i)] = (float(i) + u) / kPlaces * whole;
    source.whole->distances(way.origin(), way.direction(), length, columns.data(), distances.data(),
                            kPlaces);
    Rgb light;
    for (const float distance : distances) {
        if (!std::isfinite(distance)) continue;
        const Rgb emission = source.at(way.point(distance));
        if (const float all = sum(emission); all > 0)
            light += emission * (1 / all) * transmittance(medium, way.column(distance));
    }
    return light * (whole / kPlaces);
}

}  // namespace

Rgb Medium::albedo() const {
    const Rgb t = extinction();
    const auto share = [](float part, float whole) { return whole > 0 ? part / whole : 0.0f; };
    return {share(scattering.r, t.r), share(scattering.g, t.g), share(scattering.b, t.b)};
}

MediumWay::MediumWay(const Medium& medium, Vec3 origin, Vec3 direction)
    : density_(medium.density), origin_(origin), direction_(direction) {
    constexpr float kNothingLeft = 32;  // exp(-32) is a millionth of a rounding
    const Rgb s = medium.extinction();
    if (const float least = std::min({s.r, s.g, s.b}); least > 0) opaque_ = kNothingLeft / least;
}

float MediumWay::column(float distance) const {
    return density_ ? density_->column(origin_, direction_, distance, opaque_) : distance;
}

float MediumWay::density(float distance) const {
    return density_ ? density_->at(origin_ + direction_ * distance) : 1.0f;
}

float MediumWay::distance(float column, float length) const {
    if (density_) return density_->distance(origin_, direction_, length, column);
    return column < length ? column : kInfinity;
}

void MediumWay::distances(std::span<const float> columns, float length,
                          std::span<float> found) const {
    if (density_) {
        density_->distances(origin_, direction_, length, columns.data(), found.data(),
                            columns.size());
        return;
    }
    for (size_t i = 0; i < columns.size(); ++i) found[i] = distance(columns[i], length);
}

Rgb transmittance(const Medium& medium, float column) {
    const Rgb s = medium.extinction();
    return {pass(s.r, column), pass(s.g, column), pass(s.b, column)};
}

Rgb emitted_along(const Medium& medium, const MediumWay& way, float length, float u) {
    const float column = way.column(length);
    const Rgb light =
        medium.glow ? glow_along(medium, way, column, length, u) : even_glow(medium, column);
    return medium.source ? light + source_along(medium, way, length, u) : light;
}

MediumEvent sample_event(const Medium& medium, const MediumWay& way, float length, Rgb throughput,
                         Vec2 u, const std::optional<LightBeside>& light) {
    const float all = sum(throughput);
    if (!medium.scatters() || !(all > 0)) {
        const Rgb through = transmittance(medium, way.column(length));
        return {false, length, through, through};
    }

    const Rgb share = throughput * (1 / all), extinction = medium.extinction(),
              albedo = medium.albedo();
    // Find the part that is placed by the angle at the light
    std::optional<EvenAngles> angles;
    float by_angle = 0;
    std::optional<Rgb> through;  // the transmittance of the whole way, which takes time
    if (light && std::isfinite(length)) {
        through = transmittance(medium, way.column(length));
        angles.emplace(*light, length);
        const float nearest = std::clamp(light->along, 0.0f, length);
        if (!angles->is_empty())
            by_angle = kMostByAngle * light->share * sum(share * albedo * (Rgb(1) - *through)) *
                       sum(share * transmittance(medium, way.column(nearest)));
    }
    const float by_distance = 1 - by_angle;
    const auto scatter = [&](float distance, float column) -> MediumEvent {
        const Rgb value =
            medium.scattering * (way.density(distance) * transmittance(medium, column));
        float density = by_distance * sum(share * value);
        if (by_angle > 0) density += by_angle * angles->density(distance);
        return {true, distance, density > 0 ? value * (1 / density) : Rgb(0), through};
    };
    if (u.x < by_angle) {
        const float distance = angles->sample(u.y);
        return scatter(distance, way.column(distance));
    }
    // Draw the rest by a channel's exponential
    float v = (u.x - by_angle) / by_distance;
    int channel = 0;
    while (channel < 2 && v >= share[channel]) v -= share[channel++];
    if (v < albedo[channel] * share[channel]) {  // rather than be absorbed
        const float column = -std::log1p(-u.y) / extinction[channel];
        const float distance = way.distance(column, length);
        if (distance < length) return scatter(distance, column);
    }
    if (!through) through = transmittance(medium, way.column(length));
    const float probability = by_distance * sum(share * (Rgb(1) - albedo * (Rgb(1) - *through)));
    return {false, length, probability > 0 ? *through * (1 / probability) : Rgb(0), through};
}

}  // namespace covtrace
