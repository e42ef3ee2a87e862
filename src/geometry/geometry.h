/// All shapes of a scene behind Embree: intersection, occlusion, and the local geometry of a hit.
/// Embree's types stay in the .cpp files of this folder. Times are the scene's, clamped to the
/// camera's shutter. Interfaces with no medium on either side are not there, nor are shapes that
/// alpha hides altogether.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "geometry/hit.h"

namespace covtrace {

struct Affine;

/// A shape as it stands in the scene.
struct PlacedShape {
    /// The shape, whose object_to_world places it over time. Objects of instances keep their
    /// object-to-instance transform there; the instance's comes on top (SurfaceHit::instance).
    ShapeDescription description;
    bool flip_normal = false;  ///< reverse orientation xor mirrored transform
    bool is_instanced = false;
    bool lets_light_pass = false;  ///< whether it is an emitter that rays pass
    bool is_pane = false;          ///< pane.h
    bool is_left_freely = false;   ///< whether rays within it pass it

    /// Whether rays pass it somewhere, or from some side.
    bool may_let_pass() const { return description.alpha >= 0 || is_left_freely; }
};

/// Corners of a triangle or of half a patch in world space at some time.
struct WorldTriangle {
    Vec3 p0, p1, p2;
};

/// A ray among others that look for their nearest hits.
struct HitQuery {
    const Ray* ray = nullptr;
    SurfaceHit* hit = nullptr;  ///< to be filled where there is a hit
    bool found = false;
};

/// A ray among others that look whether anything is in their way.
struct OcclusionQuery {
    const Ray* ray = nullptr;
    bool occluded = false;
};

/// A place of a shape where its alpha texture is looked up.
struct AlphaPlace {
    Vec2 uv;
    Vec3 position;                    ///< world space
    VertexPlace vertices;             ///< in a mesh whose vertices have values
    Vec3 normal = {};                 ///< unit, of the geometry, world space
    float facing = kSeenFromNowhere;  ///< SurfaceHit::facing
};
/// Opacity of a shape's alpha texture at a place.
using AlphaLookup = std::function<float(TextureId, const AlphaPlace&)>;

class Geometry {
  public:
    /// Builds the acceleration structures. `isa`: empty, or one of sse2, avx, avx2, avx512. Throws
    /// Error(limit) where memory runs out.
    explicit Geometry(const SceneDescription& scene, const std::string& isa = {});
    ~Geometry();
    Geometry(Geometry&&) noexcept;
    Geometry& operator=(Geometry&&) noexcept;

    /// Sets the opacity of alpha textures; without it they count as opaque. `lookup` must be
    /// thread-safe.
    void set_alpha(AlphaLookup lookup);

    /// Finds the nearest hit in (0, ray.t_max) of shapes that rays of its kind see; false where
    /// there is none. Thread-safe.
    ///
    /// Where alpha is between 0 and 1, a hash of the ray and its sample decides whether it passes,
    /// so the same ray always does the same.
    bool intersect(const Ray& ray, SurfaceHit& hit) const;
    /// Finds the nearest hit of a camera ray, as `intersect` does, but without surfaces that hold
    /// the ray's origin: these are seen edge on, which is not at all. A camera may stand on the
    /// plane of a floor or of a wall.
    bool intersect_seen(const Ray& ray, SurfaceHit& hit) const;
    /// Whether any surface that shadow rays see, but for interfaces, lies in (0, ray.t_max),
    /// whatever the ray's kind. Thread-safe.
    bool occluded(const Ray& ray) const;
    /// Whether anything that `occluded` tells of but panes, or a mix, lies in (0, ray.t_max), and
    /// alpha lets nothing through: where it does, the way through panes and its density find out,
    /// and a third draw would take light from both.
    bool blocked(const Ray& ray) const;
    /// Finds the nearest hit in (0, ray.t_max) of what scattered rays of any kind see, but panes.
    bool intersect_behind_panes(const Ray& ray, SurfaceHit& hit) const;
    /// Do for many rays what `intersect`, `intersect_seen`, `occluded` and `blocked` do for one, in
    /// less time. Each ray gets the same bits as from those, whichever others are with it.
    void intersect(std::span<HitQuery> queries) const;
    void intersect_seen(std::span<HitQuery> queries) const;
    void occluded(std::span<OcclusionQuery> queries) const;
    void blocked(std::span<OcclusionQuery> queries) const;
    /// `origin` moved off the surface of `hit` to the side of `direction`, so that a ray from there
    /// does not meet it again.
    static Vec3 offset_origin(const SurfaceHit& hit, Vec3 direction);

    DifferentialGeometry differential(const SurfaceHit& hit) const;
    /// Second-order geometry at a hit, where the frame of hit.ns and hit.tangent is known.
    DifferentialGeometry differential(const SurfaceHit& hit, const Frame& tangent) const;

    const std::vector<PlacedShape>& shapes() const;
    /// Corners of a mesh's triangle (or of half a patch: halves 2i and 2i+1 of patch i), at `time`.
    /// Not for instanced shapes.
    WorldTriangle world_triangle(uint32_t shape, uint32_t triangle, float time) const;
    /// Whether a shape moves while the shutter is open. Not for instanced shapes.
    bool moves(uint32_t shape) const;
    /// The map from a shape's own space to the world at `time`, as rays find it: for what moves, it
    /// has the roundings of Embree's way from pose to pose. Not for instanced shapes.
    Affine world_from_object(uint32_t shape, float time) const;
    /// The instruction set that rays are traced with: as asked for, or what Embree chose ("sse2" to
    /// "avx512").
    const std::string& isa() const;
    /// Whether any shape is, or by its mix may be, no surface but a border between media.
    bool has_interfaces() const;
    /// Whether any shape is a pane.
    bool has_panes() const;
    /// Whether rays that were scattered differently (kScatteredRays) meet different shapes.
    bool kinds_differ() const;
    /// Whether anything is in the way of shadow rays alone, or of scattered rays alone.
    bool shadows_differ() const;
    /// Box around all shapes over the whole shutter. Empty scene: a unit box about the origin.
    Bounds3 bounds() const;
    /// Bytes held by the shapes; neither Embree's nor meshes of the description are counted.
    size_t memory() const;
    /// Most bytes that Embree has held: its hierarchies, and the memory that building them took.
    size_t embree_memory() const;

    /// Tables of the placed shapes, for this folder and src/occluders; see placed_scene.h.
    struct Impl;
    const Impl& impl() const { return *impl_; }

  private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace covtrace
