/// Rays that tell what the camera sees of a scene that may lack light, and if light gets there.
#pragma once

#include <vector>

#include "camera/camera.h"
#include "geometry/geometry.h"
#include "scene/scene_description.h"
#include "texture/texture.h"

namespace covtrace {

class Lights;
class Sampler;

/// Follows rays through a scene before its lights are built. The scene, its geometry, of which
/// alpha is to be set, and its textures must outlive it. Deterministic.
class ViewProbe {
  public:
    ViewProbe(const SceneDescription& scene, const Geometry& geometry,
              const TextureStore& textures);

    /// The camera's ray through a point of the picture, in [0, 1]^2.
    Ray view_ray(float x, float y) const;
    /// Follows a ray past surfaces that it does not see: backs, borders of media and what throws no
    /// shadow. `passed`: the place of the last back. False where it meets nothing.
    bool follow(Ray ray, SurfaceHit& hit, Vec3* passed = nullptr) const;
    /// Finds the nearest surface up to `t_max` that keeps light: glass, cloth and what else lets at
    /// least half of it pass does not.
    bool meet(Ray ray, SurfaceHit& hit) const;

    /// Whether less than half of what is seen glows or is reached by light from outside, that of
    /// distant lights and the sky. As much makes the program tell of a dark image
    /// (image/darkness.h). `open`: shapes, by their place in Geometry::shapes, that let light pass.
    bool is_dark(const std::vector<bool>& open = {}) const;
    /// Whether less than half of what is seen and does not glow gets light of `lights`, straight or
    /// by way of others, that makes a white surface as bright as the first of 255 steps above
    /// black.
    bool is_dark(const Lights& lights) const;
    /// The shapes, by their place in Geometry::shapes, that are the last on most ways to the light
    /// outside on which they lie, from what is seen. Shapes that emit, and borders of media, are
    /// none of them.
    std::vector<bool> outer_walls() const;

    /// Visits the middles of a grid of the unit square.
    template <typename Visit>
    static void for_all(const Visit& visit) {
        for (int i = 0; i < kSide * kSide; ++i)
            visit((float(i % kSide) + 0.5f) / kSide, (float(i / kSide) + 0.5f) / kSide);
    }
    static constexpr int kSide = 24;  ///< places along a side of that grid

  private:
    bool glows(const SurfaceHit& hit, Vec3 w) const;
    bool is_passed(MaterialId id, const SurfaceHit& at) const;
    bool keeps_light(const SurfaceHit& hit) const;
    bool finds_light(const SurfaceHit& hit, Vec3 direction, const std::vector<bool>& open) const;
    float light_at(const SurfaceHit& hit, Vec3 view, const Lights& lights, Sampler& sampler) const;
    bool is_lit(const SurfaceHit& hit, Vec3 view, const Lights& lights, int place) const;
    template <typename Finds>
    bool is_reached(const SurfaceHit& hit, Vec3 view, const Finds& finds) const;
    template <typename Visit>
    void for_all_seen(const Visit& visit) const;

    const SceneDescription& scene_;
    const Geometry& geometry_;
    const TextureStore& textures_;
    const Camera camera_;
};

}  // namespace covtrace
