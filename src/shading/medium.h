/// Homogeneous participating media: transmittance, emission, and the choice of the place where
/// light scatters.
#pragma once

#include <optional>

#include "core/vec.h"

namespace covtrace {

struct Medium {
    Rgb absorption, scattering;  ///< coefficients per scene unit
    Rgb emission;  ///< radiance that the absorbing part emits: deep inside L = emission
    float g = 0;   ///< mean cosine of Henyey and Greenstein's phase function

    Rgb extinction() const { return absorption + scattering; }
    /// Share of the extinction that scatters; 0 where there is none.
    Rgb albedo() const;
    bool scatters() const { return !is_black(scattering); }
};

/// Transmittance exp(-extinction * distance); 1 where a channel has no extinction, whatever the
/// distance.
Rgb transmittance(const Medium& medium, float distance);

/// Radiance that the medium emits along a ray of the given length and that reaches its start:
/// absorption * emission * (1 - transmittance) / extinction, in closed form.
Rgb emitted_along(const Medium& medium, float distance);

/// The way of a ray through a piece of medium: it scatters in it, or leaves.
struct MediumEvent {
    bool scatters = false;  ///< at `distance`; false: the ray leaves at the far end
    float distance = 0;
    /// Transmittance (times scattering coefficient) over the density of the event in all channels
    /// together.
    Rgb weight{1};
};

/// A light beside a ray.
struct LightBeside {
    float along =
        0;  ///< distance along the ray to where it is nearest, on either side of the origin
    float away = 0;   ///< distance from there, above 0; of lights with extent at least its radius
    float share = 0;  ///< of the light around that comes from such lights, in [0, 1]
};

/// Chooses between a place to scatter and the way through, over `length` (may be infinite).
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
MediumEvent sample_event(const Medium& medium, float length, Rgb throughput, Vec2 u,
                         const std::optional<LightBeside>& light = std::nullopt);

}  // namespace covtrace
