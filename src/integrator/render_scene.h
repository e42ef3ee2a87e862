/// The scene that is rendered: all that a path may meet, and the guides that were learnt from it.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "integrator/guides/caustic_guide.h"
#include "integrator/guides/guide_outcome.h"
#include "integrator/guides/lamp_guide.h"
#include "integrator/guides/path_guide.h"
#include "integrator/guides/sky_guide.h"
#include "integrator/guides/specular_light_trial.h"
#include "integrator/lit_scene.h"

namespace covtrace {

/// A scene and the guides that were learnt from it before anything is rendered.
struct RenderScene : LitScene {
    /// Builds the scene, and guides unless there are to be none. `is_interrupted` may end their
    /// learning early: it is LitScene's, and the guides that are not learnt then stay without
    /// effect; it is not called after that. The other parameters, and errors, are LitScene's.
    explicit RenderScene(SceneDescription scene_description, const std::string& isa = {},
                         size_t texture_bytes = kNoTextureLimit, Guides guides = Guides::automatic,
                         std::function<bool()> is_interrupted = {});

    /// Bytes held, by use: what LitScene lists, and "guide".
    std::map<std::string, size_t> memory() const;

    /// The outcome of each guide: "caustics", "sky", "lamps", "paths", and "panes" and "mirrors":
    /// whether light is sampled through them, or by them.
    std::map<std::string, GuideOutcome> guide_outcomes() const;

    Guides guides;  ///< which guides may lead paths
    CausticGuide guide;
    SkyGuide sky_guide;
    LampGuide lamp_guide;
    PathGuide path_guide;

  private:
    void learn_guides();

    SpecularLightOutcomes specular_;
    std::map<std::string, double> learning_seconds_;  ///< by guide
};

}  // namespace covtrace
