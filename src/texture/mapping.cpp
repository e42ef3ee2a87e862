#include "texture/mapping.h"

namespace covtrace {
namespace {

/// Azimuth in [0, 2 pi).
float azimuth(Vec3 p) {
    const float phi = std::atan2(p.y, p.x);
    return phi < 0 ? phi + 2 * kPi : phi;
}

struct StGradient3 {
    Vec3 s, t;  ///< gradients of s and t by the position in texture space
};

StGradient3 gradient_by_position(const TextureMapping& mapping, Vec3 p) {
    const float r2 = p.x * p.x + p.y * p.y;
    const Vec3 azimuthal = r2 > 0 ? Vec3{-p.y, p.x, 0} / (2 * kPi * r2) : Vec3{};
    switch (mapping.kind) {
        case TextureMapping::Kind::spherical: {
            if (!(r2 > 0)) return {};
            const float r = std::sqrt(r2);
            const Vec3 polar = Vec3{p.x * p.z / r, p.y * p.z / r, -r} / (kPi * (r2 + p.z * p.z));
            return {polar, azimuthal};
        }
        case TextureMapping::Kind::cylindrical:
            return {azimuthal, {0, 0, 1}};
        default:
            return {mapping.v1, mapping.v2};
    }
}

/// The texture coordinates that a mapping by (u, v) starts from.
Vec2 mapped_uv(const TextureMapping& mapping, const TexturePoint& at) {
    const TriangleMesh* mesh = at.vertices.mesh;
    if (mapping.uv_set < 0 || !mesh || size_t(mapping.uv_set) >= mesh->more_uvs.size())
        return at.uv;
    const auto uv = at.vertices.corners(mesh->more_uvs[size_t(mapping.uv_set)]);
    const auto weights = at.vertices.weights();
    return uv[0] * weights[0] + uv[1] * weights[1] + uv[2] * weights[2];
}

/// Gradients of the mapped coordinates by the surface's (u, v).
StGradient mapped_uv_gradient(const TextureMapping& mapping, const TexturePoint& at) {
    const TriangleMesh* mesh = at.vertices.mesh;
    if (mapping.uv_set < 0 || !mesh || size_t(mapping.uv_set) >= mesh->more_uvs.size())
        return {{1, 0}, {0, 1}};
    const auto uv = at.vertices.corners(mesh->more_uvs[size_t(mapping.uv_set)]);
    const auto [by1, by2] = at.vertices.barycentric_by_uv();
    const Vec2 d1 = uv[1] - uv[0], d2 = uv[2] - uv[0];
    return {by1 * d1.x + by2 * d2.x, by1 * d1.y + by2 * d2.y};
}

}  // namespace

Vec2 map_to_st(const TextureMapping& mapping, const TexturePoint& at) {
    if (mapping.kind == TextureMapping::Kind::uv) {
        const Vec2 uv = mapped_uv(mapping, at);
        return {mapping.scale_u * uv.x + mapping.u_per_v * uv.y + mapping.delta_u,
                mapping.v_per_u * uv.x + mapping.scale_v * uv.y + mapping.delta_v};
    }
    const Vec3 p = mapping.texture_from_world.point(at.position);
    switch (mapping.kind) {
        case TextureMapping::Kind::spherical: {
            const float theta = std::atan2(std::sqrt(p.x * p.x + p.y * p.y), p.z);
            return {theta * kInvPi, azimuth(p) * 0.5f * kInvPi};
        }
        case TextureMapping::Kind::cylindrical:
            return {(kPi + std::atan2(p.y, p.x)) * 0.5f * kInvPi, p.z};
        default:
            return {mapping.delta_u + dot(p, mapping.v1), mapping.delta_v + dot(p, mapping.v2)};
    }
}

StGradient st_gradient(const TextureMapping& mapping, const TexturePoint& at, Vec3 dpdu,
                       Vec3 dpdv) {
    if (mapping.kind == TextureMapping::Kind::uv) {
        const StGradient g = mapped_uv_gradient(mapping, at);
        return {g.s * mapping.scale_u + g.t * mapping.u_per_v,
                g.s * mapping.v_per_u + g.t * mapping.scale_v};
    }
    const Transform& to_texture = mapping.texture_from_world;
    const StGradient3 g = gradient_by_position(mapping, to_texture.point(at.position));
    const Vec3 pu = to_texture.vector(dpdu), pv = to_texture.vector(dpdv);
    return {{dot(g.s, pu), dot(g.s, pv)}, {dot(g.t, pu), dot(g.t, pv)}};
}

PointFootprint footprint_on(const SurfaceHit& hit, Vec3 w, float width) {
    if (!(width > 0)) return {};
    constexpr float kMostStretched = 50;  // seen at grazing angles
    PointFootprint f;
    const Vec3 across = cross(hit.ng, w);
    const float sine = length(across);
    const Vec3 short_axis = sine > 1e-4f ? across / sine : Frame::from_z(hit.ng).x;
    const float stretch = std::min(kMostStretched, 1 / std::abs(dot(hit.ng, w)));
    f.dp = {short_axis * width, cross(hit.ng, short_axis) * (width * stretch)};
    // The pixel's extent in (u, v) follows by least squares from dp = dpdu du + dpdv dv.
    const float uu = dot(hit.dpdu, hit.dpdu), uv = dot(hit.dpdu, hit.dpdv),
                vv = dot(hit.dpdv, hit.dpdv);
    const float determinant = uu * vv - uv * uv;
    if (!(determinant > 0)) return f;
    for (size_t i = 0; i < 2; ++i) {
        const float u = dot(hit.dpdu, f.dp[i]), v = dot(hit.dpdv, f.dp[i]);
        f.duv[i] = {(vv * u - uv * v) / determinant, (uu * v - uv * u) / determinant};
    }
    return f;
}

ImageFootprint image_footprint(const TextureMapping& mapping, const TexturePoint& at) {
    const PointFootprint& f = at.footprint;
    if (f.is_point()) return {};
    if (mapping.kind == TextureMapping::Kind::uv) {
        const StGradient g = st_gradient(mapping, at, {}, {});
        const auto along = [&g](Vec2 duv) { return Vec2{dot(g.s, duv), dot(g.t, duv)}; };
        return {along(f.duv[0]), along(f.duv[1])};
    }
    const StGradient g = st_gradient(mapping, at, f.dp[0], f.dp[1]);
    return {{g.s.x, g.t.x}, {g.s.y, g.t.y}};
}

}  // namespace covtrace
