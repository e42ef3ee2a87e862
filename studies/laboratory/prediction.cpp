#include "laboratory/prediction.h"

#include "core/warp.h"
#include "integrator/path.h"

namespace covtrace {

namespace {

PathCovariance mean_of_paths(const RenderScene& scene, const PathReplay& replay,
                             const SensorRays& rays, int max_depth, uint32_t paths, uint64_t seed,
                             bool spread) {
    covariance::Accumulator<double> mean;
    PathRecord record;
    for (uint32_t i = 0; i < paths; ++i) {
        Sampler sampler(seed, int(rays.film().x), int(rays.film().y), i);
        const Sampler::CameraSample u = sampler.camera();
        SensorOffset offset{};
        if (spread) {
            const Vec2 lens = square_to_disc(u.lens);
            offset = {0, 0, lens.x, lens.y, double(u.time) - 0.5};
        }
        trace_path(scene, rays(offset), sampler, max_depth, &record);
        const PathCovariance p = replay(record);
        mean.add(p.sigma, p.weight);
    }
    return {mean.mean(), mean.weight() / paths};
}

}  // namespace

PathCovariance predict(const RenderScene& scene, const PathReplay& replay, const SensorRays& rays,
                       int max_depth, uint32_t paths, uint64_t seed) {
    return mean_of_paths(scene, replay, rays, max_depth, paths, seed, false);
}

PathCovariance predict_over_lens_and_shutter(const RenderScene& scene, const PathReplay& replay,
                                             const SensorRays& rays, int max_depth, uint32_t paths,
                                             uint64_t seed) {
    return mean_of_paths(scene, replay, rays, max_depth, paths, seed, true);
}

}  // namespace covtrace
