#include <algorithm>
#include <array>

#include "geometry/surface.h"

namespace covtrace {

namespace {

double largest(Vec3d v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Value and derivatives, by (u, v), of a quantity that is given at the four corners.
template <class T>
struct Bilinear {
    T value, du, dv, duv;
    Bilinear(T f00, T f10, T f01, T f11, double u, double v)
        : value((f00 * (1 - u) + f10 * u) * (1 - v) + (f01 * (1 - u) + f11 * u) * v),
          du((f10 - f00) * (1 - v) + (f11 - f01) * v),
          dv((f01 - f00) * (1 - u) + (f11 - f10) * u),
          duv(f00 - f10 - f01 + f11) {}
};

Bilinear<Vec3d> uv_at(const PatchShape& shape, uint32_t primitive, Vec2 b) {
    const auto& uvs = shape.mesh->uvs;
    if (uvs.empty()) return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, b.x, b.y};
    const auto& i = shape.mesh->patches[primitive];
    const auto corner = [&](size_t k) { return Vec3d{uvs[i[k]].x, uvs[i[k]].y, 0}; };
    return {corner(0), corner(1), corner(2), corner(3), b.x, b.y};
}

Bilinear<Vec3d> normal_at(const PatchShape& shape, uint32_t primitive, Vec2 b) {
    const auto& normals = shape.mesh->normals;
    const auto& i = shape.mesh->patches[primitive];
    const auto corner = [&](size_t k) { return shape.normal_map.vector(Vec3d(normals[i[k]])); };
    return {corner(0), corner(1), corner(2), corner(3), b.x, b.y};
}

Vec2 to_vec2(Vec3d v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y)};
}

}  // namespace

BilinearPatch PatchShape::patch(uint32_t i) const {
    const auto& k = mesh->patches[i];
    return {Vec3d(positions[k[0]]), Vec3d(positions[k[1]]), Vec3d(positions[k[2]]),
            Vec3d(positions[k[3]])};
}

PatchShape make_patch_shape(const std::shared_ptr<const BilinearMesh>& mesh,
                            const Transform& local_from_object, bool reverse) {
    PatchShape shape;
    shape.mesh = mesh;
    shape.positions = transform_points(mesh->positions, local_from_object, 1);
    shape.normal_map = Affine::from_matrix(transpose(local_from_object.inverse_matrix()));
    if (reverse)
        for (Vec3d& row : shape.normal_map.row) row = row * -1.0;
    shape.flip = reverse != local_from_object.swaps_handedness();
    shape.parallelograms = true;
    for (uint32_t i = 0; i < mesh->patches.size() && shape.parallelograms; ++i)
        shape.parallelograms = is_parallelogram(shape.patch(i));
    return shape;
}

SurfacePoint patch_point(const PatchShape& shape, uint32_t primitive, Vec2 barycentric) {
    const BilinearPatch p = shape.patch(primitive);
    const double u = barycentric.x, v = barycentric.y;
    const Vec3d du = p.du(v), dv = p.dv(u);
    SurfacePoint point;
    point.position = p.point(u, v);
    point.error = 4 * kHalfUlp * std::max(largest(du), largest(dv));
    point.ng = normalize(cross(du, dv));
    if (dot(point.ng, point.ng) < 0.5) {
        // A collapsed edge gets the normal next to it, towards the middle of the patch.
        const double e = 1e-3;
        point.ng = normalize(cross(p.du(v + e * (0.5 - v)), p.dv(u + e * (0.5 - u))));
    }
    if (shape.flip) point.ng = point.ng * -1.0;
    if (shape.parallelograms) point.error += 0.25 * std::abs(dot(p.twist(), point.ng));
    point.ns = point.ng;
    if (!shape.mesh->normals.empty()) {
        const Vec3d ns = normalize(normal_at(shape, primitive, barycentric).value);
        if (dot(ns, ns) > 0.5) {
            point.ns = ns;
            if (dot(point.ng, ns) < 0) point.ng = point.ng * -1.0;
        }
    }
    const Bilinear<Vec3d> uv = uv_at(shape, primitive, barycentric);
    point.uv = to_vec2(uv.value);
    solve_tangents(du, dv, to_vec2(uv.du), to_vec2(uv.dv), point.ng, point.dpdu, point.dpdv);
    return point;
}

SurfaceDerivatives patch_derivatives(const PatchShape& shape, uint32_t primitive,
                                     Vec2 barycentric) {
    const BilinearPatch p = shape.patch(primitive);
    SurfaceDerivatives d;
    d.dpda = p.du(barycentric.y);
    d.dpdb = p.dv(barycentric.x);
    const Bilinear<Vec3d> uv = uv_at(shape, primitive, barycentric);
    d.duvda = to_vec2(uv.du);
    d.duvdb = to_vec2(uv.dv);
    if (shape.mesh->normals.empty()) {
        // The derivatives of pu x pv need the twist alone: the pure second derivatives of a
        // bilinear patch vanish.
        d.n = cross(d.dpda, d.dpdb);
        if (!shape.parallelograms) {
            d.dnda = cross(d.dpda, p.twist());
            d.dndb = cross(p.twist(), d.dpdb);
        }
        return d;
    }
    const Bilinear<Vec3d> n = normal_at(shape, primitive, barycentric);
    d.n = n.value;
    d.dnda = n.du;
    d.dndb = n.dv;
    return d;
}

}  // namespace covtrace
