/// A ray, and the surface point that it hits.
#pragma once

#include <cstdint>

#include "core/frame.h"
#include "core/vec.h"
#include "geometry/vertex_place.h"
#include "scene/scene_description.h"

namespace covtrace {

struct Ray {
    Vec3 origin;
    Vec3 direction;  ///< unit length
    float time = 0;
    float t_max = kInfinity;
    RayKind kind = RayKind::any;  ///< decides which shapes it meets
    uint32_t sample = 0;          ///< tells the rays of a pixel's sample from those of others
};

/// The cosine of the angle of sight where there is no direction of sight.
inline constexpr float kSeenFromNowhere = 2;

/// The point where a ray meets a surface, all in world space at the ray's time.
struct SurfaceHit {
    float t = 0;  ///< distance along the ray
    Vec3 position;
    float position_error = 0;  ///< bound on the distance between `position` and the true surface
    Vec3 ng;  ///< unit geometric normal on the shape's outside (emitting) side; not turned to the
              ///< viewer
    Vec3 ns;  ///< unit shading normal in the hemisphere of ng
    float facing = kSeenFromNowhere;  ///< cosine between ns and the ray, negative from behind ng
    Vec3 dpdu, dpdv;                  ///< derivatives of the position by `uv`
    Vec3 tangent;                     ///< of shading: the mesh's own, else dpdu
    Vec2 uv;
    float time = 0;
    uint32_t sample = 0;     ///< the ray's
    uint32_t shape = 0;      ///< index into Geometry::shapes()
    uint32_t primitive = 0;  ///< triangle or patch of the shape; 0 for spheres and disks
    uint32_t instance = 0;   ///< Embree instance, 0 where there is none: Geometry's own business
    Vec2 barycentric;        ///< Embree's (u, v) in the primitive
    const TriangleMesh* mesh = nullptr;  ///< the mesh, where its vertices have values for textures

    VertexPlace vertices() const { return {mesh, primitive, barycentric}; }
};

/// Second-order geometry and motion at a hit, for the frequency analysis only.
struct DifferentialGeometry {
    Frame tangent;  ///< z = ns
    /// Shape operator in (tangent.x, tangent.y): d ns = kappa dq, k11 k12 k22, 1 / scene unit;
    /// positive where convex seen from ns.
    float k11 = 0, k12 = 0, k22 = 0;
    Vec3 velocity;          ///< of the material point, scene units per unit of time
    Vec3 angular_velocity;  ///< rotation of its neighbourhood, radians per unit of time
    /// Texture coordinates by place: uv_from_tangent[i][j] = d uv_i / d s_j, with s = (tangent.x,
    /// tangent.y), 1 / scene unit.
    float uv_from_tangent[2][2] = {{0, 0}, {0, 0}};
};

}  // namespace covtrace
