/// Spectra of a scene: how fast its textures and its lights vary. The frequency analysis reads them
/// beside the paths that it follows.
#pragma once

#include "integrator/lit_scene.h"
#include "light/spectra.h"
#include "texture/spectra.h"

namespace covtrace {

/// The spectra of all textures and lights; thread-safe.
struct SceneSpectra {
    TextureSpectra textures;
    LightSpectra lights;

    /// Measures the scene, which must outlive this.
    explicit SceneSpectra(const LitScene& scene, TextureBandwidth bandwidth = TextureBandwidth::own)
        : textures(scene.textures, bandwidth), lights(scene.lights) {}
};

}  // namespace covtrace
