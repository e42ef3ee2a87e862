/// What the frequency analysis says about one ray of the camera.
#pragma once

#include "frequency/replay.h"
#include "laboratory/sensor_rays.h"

namespace covtrace {

/// Mean covariance of `paths` paths that all start with the central ray, weighted by luminance; the
/// weight is their mean luminance. The integrator's and the replay's own code, nothing else.
PathCovariance predict(const RenderScene& scene, const PathReplay& replay, const SensorRays& rays,
                       int max_depth, uint32_t paths, uint64_t seed);

/// The same for offsets spread over the whole lens and shutter, as the analysis of an image does.
PathCovariance predict_over_lens_and_shutter(const RenderScene& scene, const PathReplay& replay,
                                             const SensorRays& rays, int max_depth, uint32_t paths,
                                             uint64_t seed);

}  // namespace covtrace
