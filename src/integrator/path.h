/// The path tracer: surfaces and media, next-event estimation, sampling of BSDFs and
/// phase functions, multiple importance sampling, Russian roulette.
#pragma once

#include <cstdint>

#include "core/sampler.h"
#include "integrator/panes.h"
#include "integrator/path_record.h"
#include "integrator/render_scene.h"

namespace covtrace {

/// Rays by their use. A way through several interfaces counts a ray for each piece.
struct RayCounts {
    /// Up to the first place that scatters, and straight on behind a medium's for the opacity.
    uint64_t camera = 0;
    uint64_t bounce = 0;  ///< rays behind that place
    uint64_t shadow = 0;  ///< towards sampled lights
    uint64_t total() const { return camera + bounce + shadow; }
    void add(const RayCounts& other) {
        camera += other.camera;
        bounce += other.bounce;
        shadow += other.shadow;
    }
};

/// Features that lead filters and denoisers: those of the vertex where the path first leaves by a
/// wide lobe, or ends. Objects seen in mirrors, through glass and in glossy coats have edges of
/// their own there, which the surfaces before know nothing of. A path that leaves the scene behind
/// a mirror tells of the mirror.
struct PathFeatures {
    Rgb albedo;  ///< albedo as the viewer sees it: times what the mirrors and panes let through
    /// Shading normal there, towards the place where the path comes from; 0 in a medium.
    Vec3 normal;
    float depth = 0;  ///< length of the path from the camera to there
};

/// The result of a path for its pixel. Its first vertex is the first surface, or the first place in
/// a medium, where it scatters.
struct PathResult {
    Rgb radiance;
    /// Part of the radiance that comes from emitters in view, see PathVertex::in_view.
    Rgb in_view;
    Rgb albedo;       ///< albedo of the first vertex; 0 where the ray leaves the scene
    Vec3 normal;      ///< shading normal of the first vertex towards the viewer; 0 in a medium
    float depth = 0;  ///< distance of the first vertex from the camera, 0 where there is none
    bool hit = false;
    /// Opacity of what the camera's ray meets straight on, where LitScene::tells_opacity: 1 less
    /// the transmittance to where nothing is seen, in the mean of the channels. Its mean over
    /// samples is the opacity; weights of mixtures may put one sample below 0.
    float opacity = 0;
    Vec3 position;          ///< of the first vertex
    Vec3 geometric_normal;  ///< of the first vertex towards the viewer; 0 in a medium
    Vec2 uv;                ///< of the first vertex; 0 in a medium
    PathFeatures features;
    RayCounts rays;
    uint32_t vertices = 0;
    /// Second moment of the path's luminance that sampling light through panes took away, and the
    /// rays of `rays.shadow` that it cost.
    float saved_by_panes = 0;
    uint64_t rays_through_panes = 0;
    /// The same of sampling light by flat mirrors, and the number of samples.
    float saved_by_mirrors = 0;
    uint64_t rays_by_mirrors = 0, samples_by_mirrors = 0;
};

/// Traces one path and returns an unbiased estimate of the radiance along `ray`, whatever the
/// guides that lead it: those of sky, lamps and paths may be null. `max_depth` counts scattering
/// events as pbrt does: 0 shows emitters alone. `record` may be null; then nothing is recorded and
/// nothing is paid for it. Non-finite estimates are returned as they are: the caller counts them.
PathResult trace_path(const LitScene& scene, const CausticGuide& guide, Ray ray,
                      const Sampler& sampler, int max_depth, PathRecord* record,
                      const SkyGuide* sky_guide = nullptr, const LampGuide* lamp_guide = nullptr,
                      const PathGuide* path_guide = nullptr);
/// Traces the rest of a path that leaves a place by `ray`, whose direction has the density `pdf`:
/// light behind panes, and by flat mirrors, counts with the weight that sampling it leaves to
/// paths, all other in full. No guide leads it.
PathResult trace_path_from(const LitScene& scene, const LitPlace& place, float pdf, Ray ray,
                           const Sampler& sampler, int max_depth);
/// Traces one path, led by the guides of the scene.
inline PathResult trace_path(const RenderScene& scene, Ray ray, const Sampler& sampler,
                             int max_depth, PathRecord* record) {
    return trace_path(scene, scene.guide, ray, sampler, max_depth, record, &scene.sky_guide,
                      &scene.lamp_guide, &scene.path_guide);
}

}  // namespace covtrace
