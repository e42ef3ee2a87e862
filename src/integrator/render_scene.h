/// The scene that is rendered: all that a path may meet, and the guide that was learnt from it.
#pragma once

#include "integrator/caustic_guide.h"
#include "integrator/lit_scene.h"

namespace covtrace {

/// A scene and the guide that was learnt from it before anything is rendered.
struct RenderScene : LitScene {
    /// Builds scene and guide. Parameters and errors are LitScene's.
    explicit RenderScene(SceneDescription scene_description, const std::string& isa = {},
                         size_t texture_bytes = kNoTextureLimit);

    CausticGuide guide;
};

}  // namespace covtrace
