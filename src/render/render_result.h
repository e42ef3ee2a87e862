/// The result of a render: the image and what it cost.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "image/image.h"
#include "render/pass.h"
#include "render/phase.h"

namespace covtrace {

struct RenderStatistics {
    PassStatistics covariance, radiance;
    PhaseSeconds seconds;
    /// Bytes: "film" and "plan"; with covariance tracing "prediction", "occluders" and "spectra",
    /// those of textures.
    std::map<std::string, size_t> memory;
    double samples_per_pixel = 0;  ///< average taken
    /// The factor k of N = k sqrt|S|, with DensityRule::thesis: as asked for or as the budget made
    /// it; none where the budget ended before the first plan.
    std::optional<double> density_factor;
    uint64_t rejected = 0;  ///< rejected samples of the whole film, also those of earlier processes
    std::vector<RejectedSample> first_rejected;
};

struct RenderResult {
    /// The image with all layers of the method and the metadata that the film knows. Empty for a
    /// shard.
    Image image;
    RenderStatistics statistics;
    bool complete = false;  ///< false: cancelled, or not all samples taken
    /// Whether the time was over before all pixels had the samples that an image is made of.
    bool is_below_least = false;
};

}  // namespace covtrace
