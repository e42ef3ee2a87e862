/// Photons that the guide to caustics learns from.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"

namespace covtrace {

struct LitScene;

/// Light that arrived at a point over glossy surfaces.
struct CausticPhoton {
    /// A point moved off its surface to the lit side, and the unit normal there on that side.
    Vec3 position, normal;
    float time = 0;
    Vec3 direction;  ///< unit, towards the place where the light came from
    /// Distance of the light along the unfolded path; infinite for distant light.
    float distance = 0;
    float weight = 0;  ///< luminance
    uint64_t source =
        0;  ///< hash of the light and of the surfaces on the way, and how each turned it
};

/// Sends light over the glossy surfaces that `count` camera paths meet, the first of them number
/// `first`, and over those around them, and returns the photons that arrive on surfaces that spread
/// light. Their weights compare the photons of one place; sums of them mean nothing. The result is
/// deterministic.
std::vector<CausticPhoton> trace_caustic_photons(const LitScene& scene, int64_t first,
                                                 int64_t count);

}  // namespace covtrace
