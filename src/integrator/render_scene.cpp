#include "integrator/render_scene.h"

#include <chrono>
#include <type_traits>
#include <utility>

namespace covtrace {

RenderScene::RenderScene(SceneDescription scene_description, const std::string& isa,
                         size_t texture_bytes, Guides which)
    : LitScene(std::move(scene_description), isa, texture_bytes), guides(which) {
    if (guides == Guides::none) return;
    const auto learn = [this](auto& learnt, const char* name, const auto&... others) {
        using Guide = std::decay_t<decltype(learnt)>;
        const auto start = std::chrono::steady_clock::now();
        learnt = Guide(static_cast<const LitScene&>(*this), others...);
        learning_seconds_[name] =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    learn(guide, "caustics");
    learn(sky_guide, "sky");
    learn(lamp_guide, "lamps");
    learn(path_guide, "paths", guide, sky_guide, lamp_guide);
}

std::map<std::string, GuideOutcome> RenderScene::guide_outcomes() const {
    std::map<std::string, GuideOutcome> outcomes{{"caustics", guide.outcome()},
                                                 {"sky", sky_guide.outcome()},
                                                 {"lamps", lamp_guide.outcome()},
                                                 {"paths", path_guide.outcome()}};
    for (const auto& [name, seconds] : learning_seconds_) outcomes[name].seconds = seconds;
    return outcomes;
}

std::map<std::string, size_t> RenderScene::memory() const {
    std::map<std::string, size_t> bytes = LitScene::memory();
    for (const auto& [name, outcome] : guide_outcomes()) bytes["guide"] += outcome.bytes;
    return bytes;
}

}  // namespace covtrace
