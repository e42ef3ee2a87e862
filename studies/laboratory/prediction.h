/// The prediction of the frequency analysis for one ray of the camera.
#pragma once

#include "frequency/replay.h"
#include "laboratory/sensor_rays.h"

namespace covtrace {

/// Mean covariance of `paths` paths that all start with the central ray, weighted by luminance; the
/// weight is their mean luminance. Only the integrator's and the replay's own code is used.
PathCovariance predict(const RenderScene& scene, const PathReplay& replay, const SensorRays& rays,
                       int max_depth, uint32_t paths, uint64_t seed);

/// Mean covariance of paths whose offsets are spread over the whole lens and shutter, as the
/// analysis of an image takes them.
PathCovariance predict_over_lens_and_shutter(const RenderScene& scene, const PathReplay& replay,
                                             const SensorRays& rays, int max_depth, uint32_t paths,
                                             uint64_t seed);

}  // namespace covtrace
