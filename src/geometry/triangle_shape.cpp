#include <algorithm>
#include <array>

#include "geometry/surface.h"

namespace covtrace {

namespace {

struct Corners {
    std::array<uint32_t, 3> index;
    Vec3d p0, e1, e2;  ///< edges p1 - p0 and p2 - p0
    Vec2 uv0, duv1, duv2;
};

Corners corners(const TriangleShape& shape, uint32_t primitive) {
    Corners c;
    const TriangleMesh& mesh = *shape.mesh;
    c.index = mesh.triangles[primitive];
    c.p0 = Vec3d(shape.positions[c.index[0]]);
    c.e1 = Vec3d(shape.positions[c.index[1]]) - c.p0;
    c.e2 = Vec3d(shape.positions[c.index[2]]) - c.p0;
    const auto uvs = uv_corners(mesh, primitive);
    c.uv0 = uvs[0];
    c.duv1 = uvs[1] - c.uv0;
    c.duv2 = uvs[2] - c.uv0;
    return c;
}

double largest(Vec3d v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

TriangleShape make_triangle_shape(const std::shared_ptr<const TriangleMesh>& mesh,
                                  const Transform& local_from_object, bool reverse) {
    TriangleShape shape;
    shape.mesh = mesh;
    shape.positions = transform_points(mesh->positions, local_from_object, 1);
    shape.normal_map = Affine::from_matrix(transpose(local_from_object.inverse_matrix()));
    if (reverse)
        for (Vec3d& row : shape.normal_map.row) row = row * -1.0;
    shape.tangent_map = Affine::from_matrix(local_from_object.matrix());
    shape.flip = reverse != local_from_object.swaps_handedness();
    return shape;
}

void prefetch_corner_numbers(const TriangleShape& shape, uint32_t primitive) {
    __builtin_prefetch(&shape.mesh->triangles[primitive]);
}

void prefetch_corners(const TriangleShape& shape, uint32_t primitive) {
    const TriangleMesh& mesh = *shape.mesh;
    for (const uint32_t corner : mesh.triangles[primitive]) {
        __builtin_prefetch(&shape.positions[corner]);
        if (!mesh.normals.empty()) __builtin_prefetch(&mesh.normals[corner]);
        if (!mesh.uvs.empty()) __builtin_prefetch(&mesh.uvs[corner]);
    }
}

SurfacePoint triangle_point(const TriangleShape& shape, uint32_t primitive, Vec2 barycentric) {
    const Corners c = corners(shape, primitive);
    const double b1 = barycentric.x, b2 = barycentric.y;
    SurfacePoint point;
    point.position = c.p0 + c.e1 * b1 + c.e2 * b2;
    // The bound on the error comes from Embree's tests, which work with corners relative to the
    // origin of the ray, in single precision.
    point.error = 4 * kHalfUlp * std::max(largest(c.e1), largest(c.e2));
    point.ng = normalize(cross(c.e1, c.e2));
    if (shape.flip) point.ng = point.ng * -1.0;
    point.ns = point.ng;
    const auto interpolated = [&](const std::vector<Vec3>& v) {
        return Vec3d(v[c.index[0]]) * (1 - b1 - b2) + Vec3d(v[c.index[1]]) * b1 +
               Vec3d(v[c.index[2]]) * b2;
    };
    if (!shape.mesh->normals.empty()) {
        const Vec3d ns = normalize(shape.normal_map.vector(interpolated(shape.mesh->normals)));
        if (dot(ns, ns) > 0.5) {
            // The outside is the side of the vertex normals, as in pbrt.
            point.ns = ns;
            if (dot(point.ng, ns) < 0) point.ng = point.ng * -1.0;
        }
    }
    if (has_vertex_values(*shape.mesh)) point.vertices = {shape.mesh.get(), primitive, barycentric};
    point.uv = c.uv0 + c.duv1 * barycentric.x + c.duv2 * barycentric.y;
    solve_tangents(c.e1, c.e2, c.duv1, c.duv2, point.ng, point.dpdu, point.dpdv);
    if (!shape.mesh->tangents.empty())
        point.tangent = shape.tangent_map.vector(interpolated(shape.mesh->tangents));
    return point;
}

SurfaceDerivatives triangle_derivatives(const TriangleShape& shape, uint32_t primitive,
                                        Vec2 barycentric) {
    const Corners c = corners(shape, primitive);
    SurfaceDerivatives d;
    d.dpda = c.e1;
    d.dpdb = c.e2;
    d.duvda = c.duv1;
    d.duvdb = c.duv2;
    if (shape.mesh->normals.empty()) {
        d.is_flat = true;
        return d;
    }
    const auto& normals = shape.mesh->normals;
    const Vec3d n0 = shape.normal_map.vector(Vec3d(normals[c.index[0]]));
    d.dnda = shape.normal_map.vector(Vec3d(normals[c.index[1]])) - n0;
    d.dndb = shape.normal_map.vector(Vec3d(normals[c.index[2]])) - n0;
    d.n = n0 + d.dnda * barycentric.x + d.dndb * barycentric.y;
    return d;
}

}  // namespace covtrace
