/// The samples of `--method hybrid` without their reconstruction, for tools that compare several.
#pragma once

#include "prediction/covariance_buffer.h"
#include "render/hybrid_film.h"
#include "render/job.h"

namespace covtrace {

struct HybridSamples {
    std::vector<Film> film;  ///< both halves
    Prediction prediction;   ///< smoothed, as the reconstruction uses it
};

/// Pilot, plans and rounds up to the job's budget.
HybridSamples trace_hybrid(RenderJob& job);

}  // namespace covtrace
