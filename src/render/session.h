/// One render from scene to image: passes, plan, reconstruction, layers.
#pragma once

#include <map>
#include <string>

#include "render/film.h"
#include "render/options.h"
#include "render/pass.h"
#include "render/progress.h"

namespace covtrace {

struct RenderStatistics {
    PassStatistics covariance, radiance;
    std::map<std::string, double> seconds;  ///< per phase: "grid" or "outlines", "covariance",
                                            ///< "plan", "radiance", "reconstruction"
    /// Bytes: "film"; "prediction" and "occluders" with covariance tracing.
    std::map<std::string, size_t> memory;
    double samples_per_pixel = 0;  ///< average taken
};

struct RenderResult {
    Image image;  ///< all layers of the method, without the metadata that only the caller knows
    RenderStatistics statistics;
    bool complete = false;  ///< false: cancelled, or not all samples taken
};

/// Applies resolution, crop, shutter, focus and f-number. Throws Error(usage) for a crop outside
/// the frame, Error(limit) for sizes that no machine holds.
void apply(const SceneOverrides& overrides, SceneDescription& scene);

/// The pixels that a description asks for: its crop window or pixel bounds within the frame.
PixelBounds render_region(const FilmDescription& film);

/// Renders. Calls scene.prepare_spectra() where the method needs it. Throws Error(limit) where
/// memory runs out.
RenderResult render(RenderScene& scene, const RenderOptions& options, Monitor& monitor);

}  // namespace covtrace
