#include "integrator/guides/specular_light_trial.h"

#include "core/parallel.h"
#include "integrator/guides/block_brightness.h"
#include "integrator/guides/training_places.h"

namespace covtrace {

namespace {

constexpr uint64_t kTrialKey = 0x70616e6573ull;  // key of the random numbers, "panes"
constexpr int64_t kMostPaths = 4096, kPathsPerChunk = 64;
constexpr int kDepth = 8;               // most scattering events of a path
constexpr double kMostRelative = 20.0;  // brightness of a path over its block's that counts

/// Time of rays through panes and by mirrors over that of as many others, which draw light and
/// shade as well: 0.25 to 1 in the scenes of docs/decisions/0121.
constexpr double kTimeOfRays = 0.5;
/// The same of a sample of light by a mirror, whose rays come on top: 0.4 to 0.7 in the bathrooms
/// of docs/decisions/0133.
constexpr double kTimeOfSample = 0.6;

struct TriedPath {
    uint16_t block = 0;
    float light = 0, saved_by_panes = 0, saved_by_mirrors = 0;
    uint64_t rays = 0;              ///< without those of either
    double panes = 0, mirrors = 0;  ///< time that they take, in such rays
};

float finite_or_zero(float v) {
    return std::isfinite(v) ? v : 0.0f;
}

std::vector<TriedPath> trace(const LitScene& scene, int64_t count) {
    std::vector<TriedPath> paths(static_cast<size_t>(count));
    const CausticGuide no_guide;
    const int depth = std::min(kDepth, scene.description.max_depth);
    parallel_for((count + kPathsPerChunk - 1) / kPathsPerChunk, [&](int64_t chunk) {
        for (int64_t i = chunk * kPathsPerChunk; i < std::min(count, (chunk + 1) * kPathsPerChunk);
             ++i) {
            scene.throw_if_interrupted();
            const TrainingPath path = training_path(scene, kTrialKey, static_cast<uint64_t>(i));
            const PathResult found =
                trace_path(scene, no_guide, path.ray, path.sampler, depth, nullptr);
            const float light = luminance(found.radiance - found.in_view);
            const uint64_t rays = found.rays.total();
            paths[size_t(i)] = {BlockBrightness::block(path.place),
                                finite_or_zero(light),
                                finite_or_zero(found.saved_by_panes),
                                finite_or_zero(found.saved_by_mirrors),
                                rays - found.rays_through_panes - found.rays_by_mirrors,
                                kTimeOfRays * double(found.rays_through_panes),
                                kTimeOfRays * double(found.rays_by_mirrors) +
                                    kTimeOfSample * double(found.samples_by_mirrors)};
        }
    });
    return paths;
}

/// Sums over all paths for one of the ways to sample light.
class Tally {
  public:
    void add(float saved, double around, double time) {
        saved_ += std::min(double(saved) / sqr(around), double(sqr(kMostRelative)));
        time_ += time;
    }
    /// The outcome, given the other time, the paths' second moment, and their noise: what that has
    /// beyond the light itself.
    GuideOutcome outcome(double time, double squares, double noise) const {
        GuideOutcome outcome;
        outcome.second_moment = squares > 0 ? squares / (squares + saved_) : 1;
        const double gain = saved_ > 0 ? saved_ / (noise + saved_) : 0;
        const bool pays = (1 - gain) * (1 + time_ / time) < 1;
        outcome.state = pays ? GuideState::guides : GuideState::gave_up;
        return outcome;
    }

  private:
    double saved_ = 0, time_ = 0;
};

}  // namespace

SpecularLightOutcomes try_specular_light(const LitScene& scene) {
    SpecularLightOutcomes outcomes;
    if (!scene.samples_through_panes && !scene.samples_by_mirrors) return outcomes;
    const FilmDescription& film = scene.description.film;
    const auto paths =
        trace(scene, std::min(kMostPaths, int64_t(film.width) * int64_t(film.height)));
    BlockBrightness image;
    for (const TriedPath& p : paths) image.add(p.block, p.light);
    double squares = 0, sum = 0, rays = 0;
    Tally panes, mirrors;
    for (const TriedPath& p : paths) {
        rays += double(p.rays);
        const double around = image.is_black() ? kInfinity : image.around(p.block);
        const double relative = std::min(double(p.light) / around, kMostRelative);
        squares += sqr(relative);
        sum += relative;
        panes.add(p.saved_by_panes, around, p.panes);
        mirrors.add(p.saved_by_mirrors, around, p.mirrors);
    }
    const double noise = squares - sqr(sum) / double(paths.size());
    if (scene.samples_through_panes) outcomes.panes = panes.outcome(rays, squares, noise);
    if (scene.samples_by_mirrors) outcomes.mirrors = mirrors.outcome(rays, squares, noise);
    return outcomes;
}

}  // namespace covtrace
