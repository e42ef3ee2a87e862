#include "shading/normal_map.h"

#include <cmath>

namespace covtrace {

namespace {

/// Change of the unmapped normal along the tangent vector `t`.
Vec3 normal_change(const DifferentialGeometry& g, Vec3 t) {
    const float a = dot(t, g.tangent.x), b = dot(t, g.tangent.y);
    return g.tangent.x * (g.k11 * a + g.k12 * b) + g.tangent.y * (g.k12 * a + g.k22 * b);
}

template <typename Mesh>
bool has_vertex_normals(const ShapeDescription& shape) {
    const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&shape.geometry);
    return mesh && !(*mesh)->normals.empty();
}

bool has_tangents(const ShapeDescription& shape) {
    const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&shape.geometry);
    return mesh && !(*mesh)->tangents.empty();
}

/// The vector v, turned by the smallest rotation that takes the unit vector `from` to `to`.
Vec3 turned(Vec3 v, Vec3 from, Vec3 to) {
    const Vec3 axis = cross(from, to), across = cross(axis, v);
    return v + across + cross(axis, across) / (1 + dot(from, to));
}

/// Step of a parameter that moves by `footprint` along its tangent; not so small that the
/// parameter's rounding shows.
float step(float footprint, Vec3 tangent, float parameter) {
    constexpr float kRoundings = 64 * 0x1p-23f;
    const float wanted = footprint / length(tangent);
    const float least = kRoundings * std::max(std::abs(parameter), 1e-3f);
    return wanted > least && std::isfinite(wanted) ? wanted : least;
}

}  // namespace

NormalMap::NormalMap(const MaterialDescription& material, const TextureStore& textures,
                     const PlacedShape& shape, const SurfaceHit& hit,
                     const DifferentialGeometry& base, float footprint, MappedLayer layer)
    : material_(material),
      normal_map_(material.normal_map),
      displacement_(material.displacement),
      normal_scale_(material.normal_scale),
      textures_(textures),
      hit_(hit),
      base_(base),
      dpdu_(hit.dpdu),
      dpdv_(hit.dpdv) {
    if (layer == MappedLayer::clearcoat) {
        normal_map_ = material.clearcoat->normal_map;
        displacement_ = -1;
        normal_scale_ = material.clearcoat->normal_scale;
    }
    if (material.maps_follow_uv && dot(cross(hit.dpdu, hit.dpdv), hit.ns) < 0) y_sign_ = -1;
    if (hit.mesh && !hit.mesh->map_signs.empty())
        y_sign_ *= static_cast<float>(hit.mesh->map_signs[hit.primitive]);
    const bool has_mesh_values =
        has_vertex_normals<TriangleMesh>(shape.description) || has_tangents(shape.description);
    const bool has_own_tangents =
        has_mesh_values && !(material.maps_follow_uv && displacement_ >= 0);
    if (has_vertex_normals<BilinearMesh>(shape.description) ||
        (has_mesh_values && !has_own_tangents)) {
        // The parameters' own, turned as the normal is; pbrt has them of patches alone.
        Vec3 flat = cross(hit.dpdu, hit.dpdv);
        if (dot(flat, hit.ns) < 0) flat = -flat;
        if (length_squared(flat) > 0 && is_finite(normalize(flat))) {
            dpdu_ = turned(hit.dpdu, normalize(flat), hit.ns);
            dpdv_ = turned(hit.dpdv, normalize(flat), hit.ns);
        }
    }
    if (has_own_tangents) {
        // Meshes with values at their vertices have pbrt's shading tangents: orthogonal to the
        // normal and to each other, both as long as the mesh's own tangent, or as dp/du.
        const Vec3 t = cross(hit.ns, hit.tangent);
        if (length_squared(t) > 0) {
            dpdv_ = t;
            dpdu_ = cross(t, hit.ns);
        }
    }
    dndu_ = normal_change(base, dpdu_);
    dndv_ = normal_change(base, dpdv_);
    step_ = {step(footprint, dpdu_, hit.uv.x), step(footprint, dpdv_, hit.uv.y)};
}

float NormalMap::height(Vec2 shift) const {
    return textures_.eval_float(
        displacement_,
        {hit_.uv + shift, hit_.position + dpdu_ * shift.x + dpdv_ * shift.y, {}, hit_.ng});
}

Frame NormalMap::frame_at(Vec2 shift) const {
    Vec3 normal = hit_.ns, tangent = dpdu_;
    if (normal_map_ >= 0) {
        const Rgb texel =
            textures_.eval(normal_map_, {hit_.uv + shift, hit_.position, {}, hit_.ng});
        Vec3 local{2 * texel.r - 1, 2 * texel.g - 1, 2 * texel.b - 1};
        local.x *= normal_scale_;
        local.y *= normal_scale_ * y_sign_;
        normal = normalize(Frame::from_z_x(hit_.ns, dpdu_).to_world(local));
    } else if (displacement_ >= 0) {
        const float here = height(shift);
        const float du = (height(shift + Vec2{step_.x, 0}) - here) / step_.x;
        const float dv = (height(shift + Vec2{0, step_.y}) - here) / step_.y;
        tangent = dpdu_ + hit_.ns * du + dndu_ * here;
        normal = normalize(cross(tangent, dpdv_ + hit_.ns * dv + dndv_ * here));
        const float s = material_.bump_strength;
        if (s != 1) {
            if (dot(normal, hit_.ns) < 0) normal = -normal;
            normal = normalize(normal * s + hit_.ns * (1 - s));
        }
    }
    if (!is_finite(normal) || normal == Vec3{}) normal = hit_.ns;
    if (dot(normal, hit_.ng) < 0) normal = -normal;
    return Frame::from_z_x(normal, tangent);
}

Frame NormalMap::frame() const {
    const Frame mapped = frame_at({});
    Vec2 axis{1, 0};
    if (material_.tangent_direction >= 0) {
        const Rgb texel = textures_.eval(material_.tangent_direction,
                                         {hit_.uv, hit_.position, {}, hit_.ng, hit_.vertices()});
        axis = {2 * texel.r - 1, 2 * texel.g - 1};
    }
    const float c = std::cos(material_.tangent_rotation), s = std::sin(material_.tangent_rotation);
    const Vec3 turned_x =
        mapped.x * (c * axis.x - s * axis.y) + mapped.y * (y_sign_ * (s * axis.x + c * axis.y));
    const float size = length(turned_x);
    return size > 0 && std::isfinite(size) ? Frame::from_z_x(mapped.z, turned_x) : mapped;
}

std::array<float, 3> NormalMap::curvature() const {
    const Frame here = frame_at({});
    const Vec3 nu = (frame_at({step_.x, 0}).z - here.z) / step_.x;
    const Vec3 nv = (frame_at({0, step_.y}).z - here.z) / step_.y;
    const auto& m = base_.uv_from_tangent;
    const Vec3 n1 = nu * m[0][0] + nv * m[1][0], n2 = nu * m[0][1] + nv * m[1][1];
    const Vec3 t1 = base_.tangent.x, t2 = base_.tangent.y;
    const auto finite = [](float k) { return std::isfinite(k) ? k : 0.0f; };
    return {finite(dot(n1, t1)), finite(0.5f * (dot(n1, t2) + dot(n2, t1))), finite(dot(n2, t2))};
}

}  // namespace covtrace
