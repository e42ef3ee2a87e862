/// What a path may meet and where it starts: geometry, materials, lights, media, camera, filter.
#pragma once

#include <map>
#include <string>

#include "geometry/geometry.h"
#include "integrator/camera.h"
#include "integrator/pixel_filter.h"
#include "light/lights.h"
#include "scene/scene_description.h"
#include "shading/material.h"
#include "shading/medium.h"
#include "texture/texture.h"

namespace covtrace {

/// Built once from a description; immutable and thread-safe afterwards.
struct LitScene {
    /// `isa`: as Geometry's; `texture_bytes`: as TextureStore's. Throws Error(scene) for images
    /// that can't be read, Error(limit) where memory runs out.
    explicit LitScene(SceneDescription scene_description, const std::string& isa = {},
                      size_t texture_bytes = kNoTextureLimit);

    /// What only the frequency analysis needs: spectra of textures and environments. Not
    /// thread-safe.
    void prepare_spectra(TextureBandwidth bandwidth = TextureBandwidth::own);

    /// Bytes held, by what they are for: "meshes", "shapes", "embree" (at its peak), "textures".
    std::map<std::string, size_t> memory() const;

    SceneDescription description;
    Geometry geometry;
    TextureStore textures;
    Lights lights;
    MaterialStore materials;  ///< reflectances as they are in the light of all `lights` together
    Camera camera;
    PixelFilter filter;
    std::vector<Medium> media;  ///< by MediumId
    /// Whether the place on the lens or the time of a ray makes any difference.
    bool has_lens_or_motion = true;
    bool has_interfaces = false;  ///< surfaces that only separate media
    /// What a ray crosses of a medium without an end, in scene units: twice the radius of the
    /// scene's bounds, as far away as pbrt-v4 puts its infinite lights; for a camera in the medium
    /// of a sphere that holds camera and lights as well.
    float unbounded_distance = 0;
};

}  // namespace covtrace
