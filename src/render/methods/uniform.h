/// `--method uniform`: the plain path tracer.
#pragma once

#include "render/job.h"

namespace covtrace {

/// Renders the job by path tracing alone; leaves the image, unless it is only a shard's, and
/// statistics in the job's result.
void render_uniform(RenderJob& job);

}  // namespace covtrace
