/// The scene as a path sees it: geometry, materials, lights, media, camera, filter.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "camera/camera.h"
#include "camera/pixel_filter.h"
#include "geometry/geometry.h"
#include "integrator/flat_mirrors.h"
#include "light/lights.h"
#include "scene/scene_description.h"
#include "shading/material.h"
#include "shading/medium.h"
#include "texture/texture.h"

namespace covtrace {

/// Whether opacity may be told (LitScene::tells_opacity), by what is known before the scene is
/// built.
bool may_tell_opacity(const SceneDescription& scene);

/// A scene, built once from a description; immutable and thread-safe afterwards.
struct LitScene {
    /// Builds the scene. `isa` is Geometry's, `texture_bytes` TextureStore's. Throws Error(scene)
    /// for images that can't be read, Error(limit) where memory runs out.
    explicit LitScene(SceneDescription scene_description, const std::string& isa = {},
                      size_t texture_bytes = kNoTextureLimit);

    /// Throws Error(interrupted) where `is_interrupted` says so.
    void throw_if_interrupted() const;

    /// Bytes held, by use: "meshes", "shapes", "embree" (at its peak), "textures", "media".
    std::map<std::string, size_t> memory() const;

    SceneDescription description;
    TextureStore textures;
    Geometry geometry;
    /// Whether walls are there for the camera alone (open_walls.h): then the rays by which it sees
    /// in perfect mirrors and through clear glass are rays of the camera, too.
    bool has_open_walls = false;
    Lights lights;
    /// Materials, with reflectances as they are in the light of all `lights` together.
    MaterialStore materials;
    Camera camera;
    PixelFilter filter;
    std::vector<Medium> media;  ///< by MediumId
    /// Whether the place on the lens or the time of a ray makes any difference.
    bool has_lens_or_motion = true;
    bool has_interfaces = false;  ///< whether there are surfaces that only separate media
    /// Whether rays that were scattered differently meet different shapes or find different lights.
    bool kinds_differ = false;
    bool shadows_differ = false;  ///< Geometry::shadows_differ
    /// Whether light is sampled through panes: where there are any, and all rays meet the same.
    bool samples_through_panes = false;
    /// Whether the camera sees nothing behind some of the scene: no sky, or holdouts.
    bool has_holes = false;
    /// Whether opacity is told before those holes (PathResult::opacity): where it is not just
    /// whether the camera's rays hit something, because of media or of holdouts.
    bool tells_opacity = false;
    FlatMirrors mirrors;  ///< none where rays of different kinds meet different shapes
    /// Whether light is sampled by those mirrors.
    bool samples_by_mirrors = false;
    /// Length of a ray's way through a medium without an end, in scene units: twice the radius of
    /// the scene's bounds, as far away as pbrt-v4 puts its infinite lights; for a camera in the
    /// medium, the radius of a sphere that holds camera and lights as well.
    float unbounded_distance = 0;
    /// Whether what is learnt from the scene before it is rendered is not wanted any more; null:
    /// always wanted. Any thread calls it.
    std::function<bool()> is_interrupted;

  private:
    /// The description with its lamps in place, and the geometry without the walls that keep the
    /// light of stand-ins out. Their rays pass where alpha lets them, so that it is set here.
    const SceneDescription& lit_description(const std::string& isa);
};

}  // namespace covtrace
