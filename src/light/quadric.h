/// Spheres and disks as emitters: points on them for light sampling, with exact densities under any
/// affine transform.
#pragma once

#include <array>
#include <optional>

#include "geometry/geometry.h"
#include "light/emitter.h"

namespace covtrace {

class EmissiveQuadric {
  public:
    /// Makes the emitter of a sphere or a disk; `geometry` must outlive it.
    EmissiveQuadric(const Geometry& geometry, uint32_t shape);

    int light_count() const { return 1; }
    int light_of(const SurfaceHit&) const { return 0; }
    /// A point on the emitter. Uniform by solid angle within the cone around a whole sphere seen
    /// from outside, uniform by object-space area otherwise. Empty where the density is not finite.
    std::optional<EmitterPoint> sample(int light, Vec3 p, float time, Vec2 u) const;
    /// Density of `sample` at a hit, per solid angle.
    float pdf(int light, Vec3 p, const SurfaceHit& hit) const;
    /// The surface's texture coordinates at a sampled point, as pbrt defines them.
    Vec2 uv(int light, const EmitterPoint& point, float time) const;
    VertexPlace vertices(int, const EmitterPoint&) const { return {}; }
    Vec3 shading_normal(int, const EmitterPoint& point, float) const { return point.normal; }
    /// Area in world space, at the start of the shutter.
    float area(int light) const;
    /// Bounds of the emitter, with the intensity that a radiance of 1 gives.
    LightBounds bounds(int light) const;

    bool is_sphere() const { return is_sphere_; }
    bool is_whole_sphere() const;
    /// Curvature seen from the outside at `time`, 1 / scene unit: positive where convex; 0 for
    /// disks.
    float curvature(float time) const;
    /// Second moments about the centroid, object space, as xx, xy, xz, yy, yz, zz; a whole sphere
    /// counts as the disc that it looks like from any side (R^2 / 4).
    std::array<double, 6> second_moments() const;
    /// The border point nearest to `p`, both in object space; empty for spheres, whose silhouette
    /// depends on the view.
    std::optional<Vec3> nearest_border(Vec3 p) const;

  private:
    struct Pose {
        Transform object_to_world;
        float scale = 0;        // factor of a similarity; 0 for any other transform
        float longest = 1;      // factor on the axis that it makes longest
        float determinant = 1;  // of the linear part, absolute value
    };
    struct ObjectPoint {
        Vec3 position, normal;
    };
    static Pose make_pose(const Transform& object_to_world);
    Pose pose(float time) const {
        return motion_ ? make_pose(geometry_->world_from_object(shape_, time).to_transform())
                       : start_;
    }
    ObjectPoint point(Vec2 u) const;  // a point of the surface, uniform by area in object space
    float object_area() const;
    bool seen_as_cone(const Pose& pose, Vec3 p, float& distance_squared) const;
    std::optional<EmitterPoint> sample_cone(const Pose& pose, Vec3 p, float distance_squared,
                                            Vec2 u) const;
    float area_pdf(const Pose& pose, Vec3 p, Vec3 position, Vec3 normal) const;
    /// Sets the unrounded place of a point that is sampled for p, and its error. `object`: the
    /// point in object space, which need not lie in the surface but for its height over a disk.
    void find_place(const Pose& pose, Vec3 p, Vec3d object, EmitterPoint& point) const;

    bool is_sphere_ = true;
    float radius_ = 1, phi_max_ = 2 * kPi;
    float z_min_ = -1, z_max_ = 1;  // of a disk both are its height
    float inner_radius_ = 0;        // of disks
    float orientation_ = 1;         // -1 where the outside is opposite to the quadric's own normal
    Pose start_;
    const Geometry* geometry_;
    uint32_t shape_;
    const AnimatedTransform* motion_ = nullptr;  // null where nothing moves
    bool moves_ = false;                         // whether it moves while the shutter is open
};

}  // namespace covtrace
