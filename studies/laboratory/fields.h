/// Light fields around a ray of the camera, as functions of the sensor's coordinates: the scene's
/// own radiance, and a probe that only a specular chain changes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "integrator/path.h"
#include "laboratory/sensor_rays.h"
#include "texture/spatial_covariance.h"

namespace covtrace {

/// An unbiased estimate of the field at an offset; `index` chooses the random numbers. Thread-safe.
using LocalField = std::function<double(const SensorOffset& offset, uint32_t index)>;

/// Luminance of the scene: one path per estimate, with the path tracer that renders images.
LocalField radiance_field(const RenderScene& scene, const SensorRays& rays, int max_depth,
                          uint64_t seed);

/// The view through a chain of mirrors and refractions of a Gaussian spot on the surface at its
/// end: real rays through the real geometry, without noise.
///
/// `record` is a path whose vertices but the last are specular; offsets follow the same events on
/// the same shapes and see 0 where they miss them. The spot is centred where the path ends and has
/// the covariance `spot` of the spectrum per unit of the end's (u, v), which move with the object.
LocalField probe_field(const RenderScene& scene, const SensorRays& rays, const PathRecord& record,
                       const SpatialCovariance2& spot);

}  // namespace covtrace
