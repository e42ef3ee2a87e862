#include "frequency/scatter.h"

#include <cmath>

#include "shading/normal_map.h"

namespace covtrace {

namespace cov = covariance;

namespace {

cov::Sym2<double> texture_spectrum(const RenderScene& scene, TextureId id, const SurfaceHit& hit,
                                   const cov::Mat2<double>& uv_from_tangent, float footprint_uv) {
    if (id < 0 || scene.textures.is_constant(id)) return {};
    const SpatialCovariance2 t =
        scene.textures.uv_covariance(id, {hit.uv, hit.position}, hit.dpdu, hit.dpdv, footprint_uv);
    return cov::texture_on_surface<double>({t.ss, t.st, t.tt}, uv_from_tangent);
}

/// A lobe as wide as this feels the horizon: the cosine limits it as it limits a diffuse surface.
constexpr float kWideLobe = 0.4f;

LightField through_lobe(const LightField& entered, const ScatterPoint& p, const LobeShare& lobe) {
    const cov::Vec3<double> out = p.outgoing;
    switch (lobe.kind) {
        case LobeKind::diffuse_reflection:
            return cov::add_texture(cov::reflect_diffuse(entered, p.surface, out), p.reflectance);
        case LobeKind::diffuse_transmission:
            return cov::add_texture(cov::reflect_diffuse(entered, p.surface, out), p.transmittance);
        case LobeKind::specular_reflection:
            return cov::reflect_specular(entered, p.surface, out);
        case LobeKind::specular_transmission:
            return cov::refract(entered, p.surface, out, lobe.eta, 1.0);
        case LobeKind::glossy_reflection:
        case LobeKind::glossy_transmission:
            break;
    }
    const bool wide = std::max(lobe.alpha_x, lobe.alpha_y) > kWideLobe;
    const LightField windowed = wide ? cov::add_cosine_window(entered, p.surface) : entered;
    const auto micro = cov::micro_ggx<double>(lobe.alpha_x, lobe.alpha_y);
    return lobe.kind == LobeKind::glossy_reflection
               ? cov::reflect_glossy(windowed, p.surface, out, micro)
               : cov::refract_glossy(windowed, p.surface, out, lobe.eta, 1.0, micro);
}

}  // namespace

ScatterPoint scatter_point(const RenderScene& scene, const PathVertex& vertex, float footprint) {
    const DifferentialGeometry d = scene.geometry.differential(vertex.hit);
    ScatterPoint p;
    p.surface = {d.tangent.z, d.tangent.x, d.tangent.y, {d.k11, d.k12, d.k22}};
    if (scene.materials.has_normal_map(vertex.material)) {
        const NormalMap map(scene.materials.description(vertex.material), scene.textures,
                            scene.geometry.shapes()[vertex.hit.shape], vertex.hit, d, footprint);
        const Frame turned = Frame::from_z_x(vertex.shading.z, d.tangent.x);
        const auto [k11, k12, k22] = map.curvature();
        p.surface = {turned.z, turned.x, turned.y, {d.k11 + k11, d.k12 + k12, d.k22 + k22}};
    }
    p.motion = {d.velocity, d.angular_velocity};
    p.outgoing = vertex.wo;
    const auto& m = d.uv_from_tangent;
    const cov::Mat2<double> uv_from_tangent{m[0][0], m[0][1], m[1][0], m[1][1]};
    const float uv_per_length =
        std::sqrt(0.5f * (sqr(m[0][0]) + sqr(m[0][1]) + sqr(m[1][0]) + sqr(m[1][1])));
    const float footprint_uv = footprint * uv_per_length;
    const MaterialTextures textures = scene.materials.textures(vertex.material);
    p.reflectance =
        texture_spectrum(scene, textures.reflectance, vertex.hit, uv_from_tangent, footprint_uv);
    p.transmittance =
        texture_spectrum(scene, textures.transmittance, vertex.hit, uv_from_tangent, footprint_uv);
    // What alpha lets stand of the surface varies like its reflectance.
    const TextureId alpha = scene.geometry.shapes()[vertex.hit.shape].description.alpha;
    const cov::Sym2<double> edges =
        texture_spectrum(scene, alpha, vertex.hit, uv_from_tangent, footprint_uv);
    p.reflectance = p.reflectance + edges;
    p.transmittance = p.transmittance + edges;
    return p;
}

cov::Sym2<double> emission_texture(const RenderScene& scene, const PathVertex& vertex,
                                   const Frame& tangent, float footprint) {
    const ShapeDescription& shape = scene.geometry.shapes()[vertex.hit.shape].description;
    if (shape.area_light < 0) return {};
    const TextureId image =
        scene.description.area_lights[static_cast<size_t>(shape.area_light)].image;
    if (image < 0 && shape.alpha < 0) return {};
    const DifferentialGeometry d = scene.geometry.differential(vertex.hit);
    const auto& m = d.uv_from_tangent;
    const auto along = [&m, &d](int i, Vec3 axis) {
        return m[i][0] * dot(d.tangent.x, axis) + m[i][1] * dot(d.tangent.y, axis);
    };
    const cov::Mat2<double> uv_from_tangent{along(0, tangent.x), along(0, tangent.y),
                                            along(1, tangent.x), along(1, tangent.y)};
    const float footprint_uv =
        footprint * std::sqrt(0.5f * (sqr(m[0][0]) + sqr(m[0][1]) + sqr(m[1][0]) + sqr(m[1][1])));
    return texture_spectrum(scene, image, vertex.hit, uv_from_tangent, footprint_uv) +
           texture_spectrum(scene, shape.alpha, vertex.hit, uv_from_tangent, footprint_uv);
}

LightField scatter(const LightField& arriving, const ScatterPoint& point, const LobeShares& lobes) {
    const LightField entered =
        cov::surface_enter(cov::motion_enter(arriving, point.motion), point.surface);
    LightField sum{{}, cov::frame_along<double>(point.outgoing)};
    double total = 0;
    for (int i = 0; i < lobes.count; ++i) {
        const LobeShare& lobe = lobes.lobes[size_t(i)];
        const double weight = luminance(lobe.value);
        if (!(weight > 0)) continue;
        const LightField left =
            cov::surface_exit(through_lobe(entered, point, lobe), point.surface);
        total += weight;
        const double share = weight / total;
        const auto aligned = cov::rotate_to(cov::motion_exit(left, point.motion), sum.frame);
        sum.sigma = (1 - share) * sum.sigma + share * aligned.sigma;
    }
    return sum;
}

}  // namespace covtrace
