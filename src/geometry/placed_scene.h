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
/// Longest direction of a ray that Embree is given: directions are of unit length up to rounding.
inline constexpr float kLongestDirection = 2;
/// Largest factor by which instances may shrink their contents: beyond it rays in their space would
/// leave Embree's range.
inline constexpr double kStrongestShrinking = 1e12;

/// An Embree scene and the shape behind each of its geometries.
struct ShapeScene {
    SceneHandle scene;
    std::vector<uint32_t> shape_of_geometry;
};

struct EmbreeInstance {
    uint32_t scene = 0;            ///< index into Geometry::Impl::scenes
    RTCGeometry handle = nullptr;  ///< kept alive by the top scene
    bool moves = false;
    Affine still;   ///< its map, where it does not move
    Motion motion;  ///< its motion, where it moves; refers to Geometry::Impl's transforms
};

/// Whether a surface holds a point for all that single precision can tell: the distance of the
/// point to the plane of the hit is within the roundings of both. The point's own roundings count
/// four times: it was written down with so many digits and has gone through the camera's matrix.
bool lies_in(Vec3 point, const SurfaceHit& hit);

/// A hit as Embree tells it.
struct EmbreeHit {
    float t = 0;
    unsigned geometry = 0, instance = 0, primitive = 0;
    Vec2 barycentric;
};

struct Geometry::Impl {
    Impl(const SceneDescription& scene, const std::string& isa);

    EmbreeDevice device;
    ShutterClock clock;
    std::vector<PlacedShape> placed;
    std::vector<LocalShape> local;    ///< for the shape of the same index in `placed`
    std::vector<bool> is_in_the_way;  ///< whether a shape is a surface for camera or shadow rays
    bool any_alpha = false;
    bool any_interface = false;
    bool any_pane = false;
    bool kinds_differ = false, shadows_differ = false;
    /// Whether Embree traces rays in packets to the bits of single rays (docs/decisions/0102).
    bool packets_are_exact = false;
    AlphaLookup alpha;
    std::vector<AnimatedTransform> instance_motions;
    std::vector<ShapeScene> scenes;  ///< one for each object and each moving shape
    std::vector<EmbreeInstance> instances;
    std::vector<int> instance_of_shape;  ///< of a shape that moves by itself; -1: it has none
    ShapeScene top;
    Bounds3 bounds;
    /// Largest coordinate of a ray's origin that Embree can follow into every instance.
    float farthest_origin = kLargestEmbreeCoordinate;

    /// Whether Embree can follow a ray: false for coordinates that are not numbers or so large that
    /// Embree's assertions end the program. Such rays meet nothing.
    bool can_follow(const Ray& ray) const {
        const auto within = [](Vec3 v, float most) {
            return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
        };
        return within(ray.origin, farthest_origin) && within(ray.direction, kLongestDirection) &&
               ray.t_max >= 0;
    }
    /// The shape of a geometry that Embree has met, by its place in Geometry::shapes.
    uint32_t shape_of(unsigned geometry, unsigned instance) const {
        const bool is_placed = instance != RTC_INVALID_GEOMETRY_ID;
        const ShapeScene& met = is_placed ? scenes[instances[instance].scene] : top;
        return met.shape_of_geometry[geometry];
    }
    /// Finds the nearest hit of the shapes in `mask`, whatever alpha says there.
    bool nearest(const Ray& ray, unsigned mask, SurfaceHit& hit) const;
    /// Describes the place of a hit of `ray`: of triangles on each other the one with its front to
    /// the ray.
    void fill(const EmbreeHit& found, const Ray& ray, SurfaceHit& hit) const;
    /// The same of the very primitive that was found.
    void fill_found(const EmbreeHit& found, const Ray& ray, SurfaceHit& hit) const;
    /// Does for a packet of rays at most what `nearest` does for one.
    void find_nearest(std::span<HitQuery> packet) const;
    /// Whether any shape in `mask`, or for kSolidMask in kAlphaMask where it is opaque, is in a
    /// ray's way.
    bool meets_any(const Ray& ray, unsigned mask) const;
    /// Does so for many rays.
    void meet_any(std::span<OcclusionQuery> queries, unsigned mask) const;
    /// Does for a packet of rays at most what `meets_any` does for one, apart from alpha.
    void meet_any_solid(std::span<OcclusionQuery> packet, unsigned mask) const;
    /// Finds the nearest hit of the shapes in `mask` that alpha does not let through.
    bool nearest_opaque(const Ray& ray, unsigned mask, SurfaceHit& hit) const;

    /// The map from the local space of an instance to the world, as Embree has it at `time`.
    Affine world_from_local(const EmbreeInstance& instance, float time) const {
        return instance.moves ? moving_map(instance, time) : instance.still;
    }

  private:
    struct Builder;
    Affine moving_map(const EmbreeInstance& instance, float time) const;
};

}  // namespace covtrace
