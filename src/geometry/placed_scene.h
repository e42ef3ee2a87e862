/// Shapes as Geometry has placed them, and their scenes in Embree: for .cpp files of this folder
/// and of src/occluders, which goes over all surfaces of a scene.
#pragma once

#include <cmath>

#include "geometry/embree_device.h"
#include "geometry/geometry.h"
#include "geometry/motion.h"
#include "geometry/surface.h"

namespace covtrace {

/// Half of the largest coordinate that Embree's rays may have (FLT_LARGE in its kernels).
inline constexpr float kLargestEmbreeCoordinate = 0.9e18f;
/// Directions are of unit length up to rounding.
inline constexpr float kLongestDirection = 2;
/// Instances may not shrink what they hold by more than this: their rays would leave Embree's
/// range.
inline constexpr double kStrongestShrinking = 1e12;

/// An Embree scene and the shape behind each of its geometries.
struct ShapeScene {
    SceneHandle scene;
    std::vector<uint32_t> shape_of_geometry;
};

struct EmbreeInstance {
    uint32_t scene = 0;            ///< into Geometry::Impl::scenes
    RTCGeometry handle = nullptr;  ///< kept alive by the top scene
    bool moves = false;
    Affine still;   ///< where it does not move
    Motion motion;  ///< where it does; refers to Geometry::Impl's transforms
};

struct Geometry::Impl {
    Impl(const SceneDescription& scene, const std::string& isa);

    EmbreeDevice device;
    ShutterClock clock;
    std::vector<PlacedShape> placed;
    std::vector<LocalShape> local;  ///< of the shape of the same index in `placed`
    std::vector<bool> is_interface;
    bool any_alpha = false;
    bool any_interface = false;
    AlphaLookup alpha;
    std::vector<AnimatedTransform> instance_motions;
    std::vector<ShapeScene> scenes;  ///< of objects and of moving shapes
    std::vector<EmbreeInstance> instances;
    ShapeScene top;
    Bounds3 bounds;
    /// Largest coordinate of a ray's origin that Embree can follow into every instance.
    float farthest_origin = kLargestEmbreeCoordinate;

    /// False for coordinates that are not numbers or so large that Embree's assertions end the
    /// program; such rays meet nothing.
    bool can_follow(const Ray& ray) const {
        const auto within = [](Vec3 v, float most) {
            return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
        };
        return within(ray.origin, farthest_origin) && within(ray.direction, kLongestDirection) &&
               ray.t_max >= 0;
    }
    /// Nearest hit of the shapes in `mask`, whatever alpha says there.
    bool nearest(const Ray& ray, unsigned mask, SurfaceHit& hit) const;
    /// Nearest hit of the shapes in `mask` that alpha does not let through.
    bool nearest_opaque(const Ray& ray, unsigned mask, SurfaceHit& hit) const;

    /// The world from the local space of an instance, as Embree has it at `time`.
    Affine world_from_local(const EmbreeInstance& instance, float time) const {
        return instance.moves ? moving_map(instance, time) : instance.still;
    }

  private:
    struct Builder;
    Affine moving_map(const EmbreeInstance& instance, float time) const;
};

}  // namespace covtrace
