/// The scene that is rendered: all that a path may meet, and the guides that were learnt from it.
#pragma once

#include "integrator/caustic_guide.h"
#include "integrator/lit_scene.h"
#include "integrator/sky_guide.h"

namespace covtrace {

/// A scene and the guides that were learnt from it before anything is rendered.
struct RenderScene : LitScene {
    /// Builds scene and guides. Parameters and errors are LitScene's.
    explicit RenderScene(SceneDescription scene_description, const std::string& isa = {},
                         size_t texture_bytes = kNoTextureLimit);

    /// Bytes held, by use: what LitScene lists, and "guide".
    std::map<std::string, size_t> memory() const;

    CausticGuide guide;
    SkyGuide sky_guide;
};

}  // namespace covtrace
