#include "integrator/guides/pane_trial.h"

#include "core/parallel.h"
#include "integrator/guides/block_brightness.h"
#include "integrator/guides/training_places.h"

namespace covtrace {

namespace {

constexpr uint64_t kTrialKey = 0x70616e6573ull;  // key of the random numbers, "panes"
constexpr int64_t kMostPaths = 4096, kPathsPerChunk = 64;
constexpr int kDepth = 8;               // most scattering events of a path
constexpr double kMostRelative = 20.0;  // brightness of a path over its block's that counts

/// Time of rays through panes over that of as many others, which draw light and shade as well: 0.25
/// to 1 in the scenes of docs/decisions/0121.
constexpr double kTimeOfRays = 0.5;

struct TriedPath {
    uint16_t block = 0;
    float light = 0, saved = 0;
    uint64_t rays = 0, rays_through_panes = 0;
};

std::vector<TriedPath> trace(const LitScene& scene, int64_t count) {
    std::vector<TriedPath> paths(static_cast<size_t>(count));
    const CausticGuide no_guide;
    const int depth = std::min(kDepth, scene.description.max_depth);
    parallel_for((count + kPathsPerChunk - 1) / kPathsPerChunk, [&](int64_t chunk) {
        for (int64_t i = chunk * kPathsPerChunk; i < std::min(count, (chunk + 1) * kPathsPerChunk);
             ++i) {
            const TrainingPath path = training_path(scene, kTrialKey, static_cast<uint64_t>(i));
            const PathResult found =
                trace_path(scene, no_guide, path.ray, path.sampler, depth, nullptr);
            const float light = luminance(found.radiance - found.in_view);
            paths[size_t(i)] = {BlockBrightness::block(path.place),
                                std::isfinite(light) ? light : 0.0f,
                                std::isfinite(found.saved_by_panes) ? found.saved_by_panes : 0.0f,
                                found.rays.total(), found.rays_through_panes};
        }
    });
    return paths;
}

}  // namespace

GuideOutcome try_panes(const LitScene& scene) {
    GuideOutcome outcome;
    if (!scene.samples_through_panes) return outcome;
    const FilmDescription& film = scene.description.film;
    const auto paths =
        trace(scene, std::min(kMostPaths, int64_t(film.width) * int64_t(film.height)));
    BlockBrightness image;
    for (const TriedPath& p : paths) image.add(p.block, p.light);
    double squares = 0, sum = 0, saved = 0, rays = 0, rays_through_panes = 0;
    for (const TriedPath& p : paths) {
        rays += double(p.rays);
        rays_through_panes += double(p.rays_through_panes);
        if (image.is_black()) continue;
        const double around = image.around(p.block);
        const double relative = std::min(double(p.light) / around, kMostRelative);
        squares += sqr(relative);
        sum += relative;
        saved += std::min(double(p.saved) / sqr(around), double(sqr(kMostRelative)));
    }
    outcome.second_moment = squares > 0 ? squares / (squares + saved) : 1;
    // Noise is what second moments have beyond the light itself
    const double noise = squares - sqr(sum) / double(paths.size());
    const double gain = saved > 0 ? saved / (noise + saved) : 0;
    const double cost = kTimeOfRays * rays_through_panes / (rays - rays_through_panes);
    const bool pays = (1 - gain) * (1 + cost) < 1;
    outcome.state = pays ? GuideState::guides : GuideState::gave_up;
    return outcome;
}

}  // namespace covtrace
