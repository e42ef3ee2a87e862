/// Everything that a path needs to find its way: geometry, materials, lights, media, camera,
/// filter.
#pragma once

#include <string>

#include "geometry/geometry.h"
#include "integrator/camera.h"
#include "integrator/caustic_guide.h"
#include "integrator/pixel_filter.h"
#include "scene/scene_description.h"
#include "shading/lights.h"
#include "shading/material.h"
#include "shading/texture.h"

namespace covtrace {

/// Built once from a description; immutable and thread-safe afterwards.
struct RenderScene {
    /// `isa`: as Geometry's. Throws Error(scene) for images that can't be read, Error(limit) where
    /// memory runs out.
    explicit RenderScene(SceneDescription scene_description, const std::string& isa = {});

    /// What only the frequency analysis needs: spectra of textures and environments. Not
    /// thread-safe.
    void prepare_spectra();

    SceneDescription description;
    Geometry geometry;
    TextureStore textures;
    Lights lights;
    MaterialStore materials;  ///< reflectances as they are in the light of all `lights` together
    Camera camera;
    PixelFilter filter;
    /// Extinction per medium, per scene unit: absorption alone (scattering is not rendered).
    std::vector<Rgb> extinction;
    CausticGuide guide;  ///< made last: it is learnt from all the rest
};

}  // namespace covtrace
