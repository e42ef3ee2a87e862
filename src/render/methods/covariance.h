/// `--method covariance`: covariance tracing: prediction, counts, Gaussian gather (Belcour 2012,
/// section 5.1).
#pragma once

#include "render/job.h"

namespace covtrace {

/// Renders the job by covariance tracing; leaves the image, unless it is only a shard's, and
/// statistics in the job's result.
void render_covariance(RenderJob& job);

}  // namespace covtrace
