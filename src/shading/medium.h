/// Participating media: transmittance, emission, and the choice of the place where light scatters.
#pragma once

#include <optional>
#include <span>

#include "core/vec.h"
#include "volume/density_grid.h"
#include "volume/emission_field.h"
#include "volume/glow.h"

namespace covtrace {

struct Medium {
    Rgb absorption, scattering;  ///< coefficients per scene unit, where the density is 1
    Rgb emission;  ///< radiance that the absorbing part emits: deep inside L = emission
    float g = 0;   ///< mean cosine of Henyey and Greenstein's phase function
    /// Factor of both coefficients, in world space; null: 1 everywhere.
    const DensityGrid* density = nullptr;
    const Glow* glow = nullptr;             ///< emission that varies, in the place of `emission`
    const EmissionField* source = nullptr;  ///< emission beside these, whatever the density
    bool is_seen = true;                    ///< MediumDescription::is_seen

    Rgb extinction() const { return absorption + scattering; }
    /// Share of the extinction that scatters; 0 where there is none.
    Rgb albedo() const;
    bool scatters() const { return !is_black(scattering); }
    bool emits() const { return glow || source || !is_black(emission); }
};

/// The way of a ray through a medium. Its column up to a distance is the integral of the density,
/// in even media the distance itself; all that a medium does to light along a ray depends on it.
class MediumWay {
  public:
    MediumWay() = default;  ///< through an even medium
    MediumWay(const Medium& medium, Vec3 origin, Vec3 direction);

    /// May end where nothing is left of the light.
    float column(float distance) const;
    float density(float distance) const;
    /// Where the column is reached; infinite if not within `length`.
    float distance(float column, float length) const;
    /// The same for many columns, which rise.
    void distances(std::span<const float> columns, float length, std::span<float> found) const;
    Vec3 point(float distance) const { return origin_ + direction_ * distance; }
    Vec3 origin() const { return origin_; }
    Vec3 direction() const { return direction_; }

  private:
    const DensityGrid* density_ = nullptr;
    Vec3 origin_, direction_;
    float opaque_ = kInfinity;  ///< column behind which nothing is left of the light
};

/// Transmittance exp(-extinction * column); 1 where a channel has no extinction, whatever the
/// column.
Rgb transmittance(const Medium& medium, float column);

/// Radiance that the medium emits along a ray over the given length and that reaches its start:
/// absorption * emission * (1 - transmittance) / extinction, in closed form. Of a glow an estimate
/// by four places, u in [0, 1): they are even in what reaches the start of light that is everywhere
/// the same, of all channels that absorb in the mean, one in each quarter. So no channel's weight
/// is more than their number times as large as that of its own places, whatever the colours. Of a
/// source it is one by as many places that are even in what all channels of it emit.
Rgb emitted_along(const Medium& medium, const MediumWay& way, float length, float u);

/// The way of a ray through a piece of medium: it scatters in it, or leaves.
struct MediumEvent {
    bool scatters = false;  ///< at `distance`; false: the ray leaves at the far end
    float distance = 0;
    /// Transmittance (times scattering coefficient) over the density of the event in all channels
    /// together.
    Rgb weight{1};
    /// Transmittance of all of the way, which takes time, where it had to be known.
    std::optional<Rgb> through = {};
};

/// A light beside a ray.
struct LightBeside {
    float along =
        0;  ///< distance along the ray to where it is nearest, on either side of the origin
    float away = 0;   ///< distance from there, above 0; of lights with extent at least its radius
    float share = 0;  ///< of the light around that comes from such lights, in [0, 1]
};

/// Chooses between a place to scatter and the way through, over `length` (may be infinite) of
/// `way`.
///
/// One of the channels, in proportion to `throughput`, draws the distance from its own exponential,
/// or goes through where the draw is an absorption; the weight divides by the mean density of all
/// channels (the balance heuristic over a single sample, Veach and Guibas 1995, "Optimally
/// combining sampling techniques for Monte Carlo rendering"). So it is unbiased for any colours,
/// and throughput * weight stays below the sum of the throughput's channels. Media that don't
/// scatter need no random numbers: weight = transmittance. `u` in [0, 1)^2.
///
/// With a light beside the way, of finite length, a part of the places is even in the angle at the
/// light (Kulla and Fajardo 2012, "Importance sampling techniques for path tracing in participating
/// media"), so that light which falls off as 1 / r^2 has a bounded weight. The part is half of what
/// scatters at all, times the light's share and the transmittance where it is nearest
/// (docs/decisions/0142); the weight divides by the density of both ways together, and is at most
/// twice as large where the ray goes through.
MediumEvent sample_event(const Medium& medium, const MediumWay& way, float length, Rgb throughput,
                         Vec2 u, const std::optional<LightBeside>& light = std::nullopt);

}  // namespace covtrace
