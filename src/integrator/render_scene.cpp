#include "integrator/render_scene.h"

#include <chrono>
#include <type_traits>
#include <utility>

#include "core/error.h"
#include "integrator/guides/specular_light_trial.h"
#include "integrator/guides/training_places.h"
#include "integrator/path.h"

namespace covtrace {

namespace {

/// Whether paths take so many rays, through thousands of interfaces say, that the thousands of them
/// which guides learn from would cost more than a render. The answer is deterministic. Throws
/// Error(interrupted) where the scene is interrupted.
bool are_paths_too_long(const LitScene& scene) {
    constexpr uint64_t kPaths = 16, kMostRays = 128;  // per path; sixty events have as many
    constexpr uint64_t kKey = 0x6c6f6e67;             // of their random numbers, "long"
    const CausticGuide no_guide;
    uint64_t rays = 0;
    for (uint64_t i = 0; i < kPaths && rays <= kPaths * kMostRays; ++i) {
        scene.throw_if_interrupted();
        const TrainingPath path = training_path(scene, kKey, i);
        const PathResult found = trace_path(scene, no_guide, path.ray, path.sampler,
                                            scene.description.max_depth, nullptr);
        rays += found.rays.total() - found.rays_through_panes - found.rays_by_mirrors;
    }
    return rays > kPaths * kMostRays;
}

}  // namespace

RenderScene::RenderScene(SceneDescription scene_description, const std::string& isa,
                         size_t texture_bytes, Guides which, std::function<bool()> interrupted)
    : LitScene(std::move(scene_description), isa, texture_bytes), guides(which) {
    is_interrupted = std::move(interrupted);
    const auto untried = [](bool samples) {
        return samples ? GuideState::guides : GuideState::unused;
    };
    specular_.panes.state = untried(samples_through_panes);
    specular_.mirrors.state = untried(samples_by_mirrors);
    try {
        if (guides != Guides::none && !are_paths_too_long(*this)) learn_guides();
    } catch (const Error& e) {
        if (e.kind() != ErrorKind::interrupted) throw;
    }
    is_interrupted = {};  // may refer to what does not live as long as the scene
}

void RenderScene::learn_guides() {
    const auto time = [this](const char* name, const auto& work) {
        const auto start = std::chrono::steady_clock::now();
        work();
        learning_seconds_[name] =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const auto learn = [&](auto& learnt, const char* name, const auto&... others) {
        using Guide = std::decay_t<decltype(learnt)>;
        time(name, [&] { learnt = Guide(static_cast<const LitScene&>(*this), others...); });
    };
    time(samples_through_panes ? "panes" : "mirrors",
         [this] { specular_ = try_specular_light(*this); });
    samples_through_panes = specular_.panes.state == GuideState::guides;
    samples_by_mirrors = specular_.mirrors.state == GuideState::guides;
    learn(sky_guide, "sky");
    learn(lamp_guide, "lamps");
    learn(guide, "caustics", sky_guide, lamp_guide);
    learn(path_guide, "paths", guide, sky_guide, lamp_guide);
}

std::map<std::string, GuideOutcome> RenderScene::guide_outcomes() const {
    std::map<std::string, GuideOutcome> outcomes{
        {"caustics", guide.outcome()},   {"sky", sky_guide.outcome()},
        {"lamps", lamp_guide.outcome()}, {"paths", path_guide.outcome()},
        {"panes", specular_.panes},      {"mirrors", specular_.mirrors}};
    for (const auto& [name, seconds] : learning_seconds_) outcomes[name].seconds = seconds;
    return outcomes;
}

std::map<std::string, size_t> RenderScene::memory() const {
    std::map<std::string, size_t> bytes = LitScene::memory();
    for (const auto& [name, outcome] : guide_outcomes()) bytes["guide"] += outcome.bytes;
    return bytes;
}

}  // namespace covtrace
