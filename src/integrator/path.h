/// The path tracer: next-event estimation, BSDF sampling, multiple importance sampling, Russian
/// roulette.
#pragma once

#include <cstdint>

#include "core/sampler.h"
#include "integrator/path_record.h"
#include "integrator/render_scene.h"

namespace covtrace {

/// Everything one path says about its pixel.
struct PathResult {
    Rgb radiance;
    Rgb in_view;      ///< the part of it that comes from emitters in view, see PathVertex::in_view
    Rgb albedo;       ///< of the first surface; 0 where the ray leaves the scene
    Vec3 normal;      ///< shading normal of the first surface towards the viewer
    float depth = 0;  ///< distance of the first surface from the camera, 0 where there is none
    bool hit = false;
    uint32_t rays = 0;  ///< rays traced, shadow rays included
    uint32_t vertices = 0;
};

/// Traces one path and returns an unbiased estimate of the radiance along `ray`. `max_depth` counts
/// scattering events as pbrt does: 0 shows emitters alone. `record` may be null; then nothing is
/// recorded and nothing is paid for it. Non-finite estimates are returned as they are: the caller
/// counts them.
PathResult trace_path(const RenderScene& scene, Ray ray, Sampler& sampler, int max_depth,
                      PathRecord* record);

}  // namespace covtrace
