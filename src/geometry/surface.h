/// Shapes in the space of the Embree scene that holds them ("local": the world for shapes that
/// stand still, the instance's space inside objects, the shape's own space for moving shapes), and
/// the differential geometry of their points. No Embree here.
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "geometry/affine.h"
#include "geometry/bilinear_patch.h"
#include "geometry/opposite_triangles.h"
#include "geometry/rounding.h"
#include "geometry/vertex_place.h"
#include "scene/scene_description.h"

namespace covtrace {

struct TriangleShape {
    std::shared_ptr<const TriangleMesh> mesh;
    std::vector<Vec3> positions;  ///< local; one spare element, for Embree's wide loads
    /// Maps the mesh's normals to local ones; turned where the orientation is reversed.
    Affine normal_map;
    Affine tangent_map;  ///< maps the mesh's tangents to local ones
    bool flip = false;   ///< whether the outside is opposite to (p1 - p0) x (p2 - p0)
    /// Pairs of triangles on each other, where fronts alone are seen; null: none.
    std::shared_ptr<const OppositeTriangles> opposites = {};
};

struct PatchShape {
    std::shared_ptr<const BilinearMesh> mesh;
    std::vector<Vec3> positions;
    Affine normal_map;
    bool flip = false;            ///< whether the outside is opposite to dp/du x dp/dv
    bool parallelograms = false;  ///< whether all patches are parallelograms, up to rounding
    BilinearPatch patch(uint32_t i) const;
};

/// Sphere or disk about the z axis of object space, with pbrt's parameters and parameterisation.
struct Quadric {
    enum class Kind { sphere, disk };
    Kind kind = Kind::sphere;
    double radius = 1;
    double z_min = -1, z_max = 1;         ///< of spheres
    double height = 0, inner_radius = 0;  ///< of disks
    double phi_max = 6.283185307179586;   ///< radians
    Affine local_from_object, object_from_local;
    bool reverse = false;
};

using LocalShape = std::variant<TriangleShape, PatchShape, Quadric>;

/// Moves a described shape to local space; vertices in parallel.
LocalShape make_local_shape(const ShapeDescription& description,
                            const Transform& local_from_object);

/// A point of a surface with its tangents, in local space.
struct SurfacePoint {
    Vec3d position;
    double error = 0;  ///< bound on the error of intersection in single precision, along the normal
    Vec3d ng;          ///< unit, on the outside
    Vec3d ns;          ///< unit, in the hemisphere of ng
    Vec3d dpdu, dpdv;
    Vec3d tangent;  ///< the mesh's own; 0: dpdu
    Vec2 uv;
    VertexPlace vertices;
};

/// Derivatives at a point by two parameters (a, b) of the shape's own choice, in local space.
struct SurfaceDerivatives {
    Vec3d dpda, dpdb;
    Vec2 duvda, duvdb;
    /// Normal field, which need not be of unit length, and its derivatives; left alone where the
    /// normal is the same everywhere.
    Vec3d n, dnda, dndb;
    bool is_flat = false;
};

/// Point and derivatives of a shape at a hit. `barycentric`: as Embree gives it; quadrics use
/// `near` instead, a local point close to the surface.
SurfacePoint surface_point(const LocalShape& shape, uint32_t primitive, Vec2 barycentric,
                           Vec3d near);
SurfaceDerivatives surface_derivatives(const LocalShape& shape, uint32_t primitive,
                                       Vec2 barycentric, Vec3d near);

/// Tangents dp/ds, dp/dt of the coordinates (s, t), whose derivatives by the parameters of dp are
/// given. Where (s, t) rests in a direction, the tangents are a thousand times as long there as the
/// larger of dpda and dpdb; an orthonormal pair where these are parallel.
void solve_tangents(Vec3d dpda, Vec3d dpdb, Vec2 duvda, Vec2 duvdb, Vec3d normal, Vec3d& dpdu,
                    Vec3d& dpdv);

/// Maps `positions` in parallel and appends `spare` elements.
std::vector<Vec3> transform_points(const std::vector<Vec3>& positions, const Transform& map,
                                   size_t spare);

// ---- functions of one kind of shape each, in triangle_shape.cpp and patch_shape.cpp
TriangleShape make_triangle_shape(const std::shared_ptr<const TriangleMesh>& mesh,
                                  const Transform& local_from_object, bool reverse);
SurfacePoint triangle_point(const TriangleShape& shape, uint32_t primitive, Vec2 barycentric);
/// Asks for the memory of a triangle's corner numbers.
void prefetch_corner_numbers(const TriangleShape& shape, uint32_t primitive);
/// Asks for the memory that `triangle_point` reads at the corners. It reads their numbers, best
/// some time after these were asked for.
void prefetch_corners(const TriangleShape& shape, uint32_t primitive);
SurfaceDerivatives triangle_derivatives(const TriangleShape& shape, uint32_t primitive,
                                        Vec2 barycentric);
PatchShape make_patch_shape(const std::shared_ptr<const BilinearMesh>& mesh,
                            const Transform& local_from_object, bool reverse);
SurfacePoint patch_point(const PatchShape& shape, uint32_t primitive, Vec2 barycentric);
SurfaceDerivatives patch_derivatives(const PatchShape& shape, uint32_t primitive, Vec2 barycentric);

}  // namespace covtrace
