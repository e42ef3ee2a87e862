/// Homogeneous participating media: transmittance, emission, and the choice of the place where
/// light scatters.
#pragma once

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

/// Chooses between a place to scatter and the way through, over `length` (may be infinite).
///
/// One of the channels, in proportion to `throughput`, draws the distance from its own exponential,
/// or goes through where the draw is an absorption; the weight divides by the mean density of all
/// channels (the balance heuristic over a single sample, Veach and Guibas 1995, "Optimally
/// combining sampling techniques for Monte Carlo rendering"). So it is unbiased for any colours,
/// and throughput * weight stays below the sum of the throughput's channels. Media that don't
/// scatter need no random numbers: weight = transmittance. `u` in [0, 1)^2.
MediumEvent sample_event(const Medium& medium, float length, Rgb throughput, Vec2 u);

}  // namespace covtrace
