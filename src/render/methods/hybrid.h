/// `--method hybrid`: prediction and samples together (docs/internals/hybrid.md).
#pragma once

#include "prediction/covariance_buffer.h"
#include "render/hybrid_film.h"
#include "render/job.h"

namespace covtrace {

/// Renders the job by the hybrid method; leaves the image, unless it is only a shard's, and
/// statistics in the job's result.
void render_hybrid(RenderJob& job);

/// The samples of a hybrid render without their reconstruction, for tools that compare several.
struct HybridSamples {
    std::vector<Film> film;  ///< both halves
    Prediction prediction;   ///< smoothed, as the reconstruction uses it
};

/// Traces pilot, plans and rounds up to the job's budget.
HybridSamples trace_hybrid(RenderJob& job);

}  // namespace covtrace
