/// One render from scene to image: passes, plan, reconstruction, layers.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "render/film.h"
#include "render/keeping.h"
#include "render/options.h"
#include "render/pass.h"
#include "render/progress.h"

namespace covtrace {

struct RenderStatistics {
    PassStatistics covariance, radiance;
    std::map<std::string, double> seconds;  ///< per phase: "grid" or "outlines", "covariance",
                                            ///< "plan", "radiance", "reconstruction", and apart
                                            ///< from that "denoise"
    /// Bytes: "film" and "plan"; "prediction" and "occluders" with covariance tracing.
    std::map<std::string, size_t> memory;
    double samples_per_pixel = 0;  ///< average taken
    /// With DensityRule::thesis: k of N = k sqrt|S|, as asked for or as the budget made it; none
    /// where the budget ended before the first plan.
    std::optional<double> density_factor;
    uint64_t rejected = 0;  ///< of all samples of the film, also those of earlier processes
    std::vector<RejectedSample> first_rejected;
};

struct RenderResult {
    /// All layers of the method; of the metadata what the film knows. Empty for a shard.
    Image image;
    RenderStatistics statistics;
    bool complete = false;  ///< false: cancelled, or not all samples taken
    /// The time was over before all pixels had the samples that an image is made of.
    bool is_below_least = false;
};

/// Applies resolution, crop, shutter, focus and f-number. Throws Error(usage) for a crop outside
/// the frame, Error(limit) for sizes that no machine holds.
void apply(const SceneOverrides& overrides, SceneDescription& scene);

/// The pixels that a description asks for: its crop window or pixel bounds within the frame.
PixelBounds render_region(const FilmDescription& film);

/// The average of samples per pixel that is asked for; none where time, error or the factor of the
/// density alone decide.
std::optional<double> target_spp(const SceneDescription& scene, const RenderOptions& options);

/// Bytes that a render takes beside its scene: "film", with plan and prediction, and "image": the
/// layers and the buffers of the reconstruction, as measured; "denoiser" where there is one.
std::map<std::string, size_t> render_memory(const FilmDescription& film,
                                            const RenderOptions& options);

/// Renders. Calls scene.prepare_spectra() where the method needs it. Throws Error(limit) where
/// memory runs out, Error(usage) where `keeping` asks for what cannot be.
RenderResult render(RenderScene& scene, const RenderOptions& options, Monitor& monitor,
                    FilmKeeping keeping = {});

}  // namespace covtrace
