/// Everything that a path needs to find its way: what it may meet, and what has been learnt of it.
#pragma once

#include "integrator/caustic_guide.h"
#include "integrator/lit_scene.h"

namespace covtrace {

/// A scene and the guide that was learnt from it before anything is rendered.
struct RenderScene : LitScene {
    /// Parameters and errors as LitScene's.
    explicit RenderScene(SceneDescription scene_description, const std::string& isa = {},
                         size_t texture_bytes = kNoTextureLimit);

    CausticGuide guide;
};

}  // namespace covtrace
