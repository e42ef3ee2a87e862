#include "frequency/scatter_point.h"

#include <cmath>

#include "shading/normal_map.h"
#include "shading/reflecting_normal.h"

namespace covtrace {

namespace cov = covariance;

namespace {

cov::Sym2<double> texture_spectrum(const LitScene& scene, const TextureSpectra& spectra,
                                   TextureId id, const SurfaceHit& hit,
                                   const cov::Mat2<double>& uv_from_tangent, float footprint_uv) {
    if (id < 0 || scene.textures.is_constant(id)) return {};
    const SpatialCovariance2 t = spectra.uv_covariance(
        id, {hit.uv, hit.position, {}, hit.ng, hit.vertices()}, hit.dpdu, hit.dpdv, footprint_uv);
    return cov::texture_on_surface<double>({t.ss, t.st, t.tt}, uv_from_tangent);
}

DifferentialGeometry geometry_at(const LitScene& scene, const PathVertex& vertex) {
    // Where nothing turns the normal, the tangents are already those of the BSDF's frame.
    return vertex.is_turned || scene.materials.turns_frame(vertex.material)
               ? scene.geometry.differential(vertex.hit)
               : scene.geometry.differential(vertex.hit, vertex.shading);
}

/// The normals as they are turned to let light mirrored towards vertex.wo leave the surface.
cov::NormalField<double> reflecting_normals(const cov::NormalField<double>& unturned,
                                            const PathVertex& vertex) {
    // Normals turn by this angle, radians, for the differences: a thousand roundings of theirs
    constexpr double kTurn = 1e-3;
    const cov::Vec3<double> here{vertex.shading.z};
    const auto change = [&](const cov::Vec3<double>& d) -> cov::Vec3<double> {
        const double size = std::sqrt(cov::dot(d, d));
        if (!(size > 0)) return {};
        const cov::Vec3<float> beside{unturned.n + (kTurn / size) * d};
        const cov::Vec3<double> there{reflecting_normal(
            normalize(Vec3{beside.x, beside.y, beside.z}), vertex.hit.ng, vertex.wo)};
        const cov::Vec3<double> turned = (size / kTurn) * (there - here);
        return turned - cov::dot(turned, here) * here;
    };
    return {here, change(unturned.d1), change(unturned.d2)};
}

constexpr unsigned bit(LobeKind kind) {
    return 1u << static_cast<unsigned>(kind);
}

/// The lobes that the recorded events have, as bits.
unsigned kinds_of_lobes(const PathVertex& vertex) {
    unsigned kinds = 0;
    const auto collect = [&kinds](const LobeShares& shares) {
        for (size_t i = 0; i < size_t(shares.count); ++i) kinds |= bit(shares.lobes[i].kind);
    };
    if (vertex.direct > 0) collect(vertex.direct_event.lobes);
    if (vertex.mirrored > 0) collect(vertex.mirrored_event.lobes);
    if (vertex.scatters) collect(vertex.next_event.lobes);
    return kinds;
}

}  // namespace

ScatterPoint::ScatterPoint(const LitScene& scene, const TextureSpectra& spectra,
                           const PathVertex& vertex, float footprint)
    : ScatterPoint(scene, spectra, vertex, footprint, geometry_at(scene, vertex)) {}

ScatterPoint::ScatterPoint(const LitScene& scene, const TextureSpectra& spectra,
                           const PathVertex& vertex, float footprint, const DifferentialGeometry& d)
    : surface{d.tangent.z, d.tangent.x, d.tangent.y, {d.k11, d.k12, d.k22}},
      shading(vertex.shading),
      leaving(cov::frame_along<double>(vertex.wo)) {
    const bool is_mapped = scene.materials.turns_frame(vertex.material);
    if (is_mapped) {
        const NormalMap map(scene.materials.description(vertex.material), scene.textures,
                            scene.geometry.shapes()[vertex.hit.shape], vertex.hit, d, footprint);
        // Positions stay on the geometry; the normal turns by both shape operators.
        const Frame axes =
            Frame::from_z_x(vertex.is_turned ? map.frame().z : vertex.shading.z, d.tangent.x);
        const auto [k11, k12, k22] = map.curvature();
        normals = {axes.z, axes.x * (d.k11 + k11) + axes.y * (d.k12 + k12),
                   axes.x * (d.k12 + k12) + axes.y * (d.k22 + k22)};
    } else if (d.k11 != 0 || d.k12 != 0 || d.k22 != 0) {
        normals = cov::normal_field(surface);
    }
    if (vertex.is_turned)
        normals = reflecting_normals(normals.value_or(cov::normal_field(surface)), vertex);
    if (is_mapped || vertex.is_turned) turned = cov::shading_surface(surface, *normals);
    if (d.velocity != Vec3{} || d.angular_velocity != Vec3{})
        motion = {d.velocity, d.angular_velocity};
    const unsigned kinds = kinds_of_lobes(vertex);
    const bool reflects = (kinds & bit(LobeKind::diffuse_reflection)) != 0,
               transmits = (kinds & bit(LobeKind::diffuse_transmission)) != 0;
    if (!reflects && !transmits) return;
    const auto& m = d.uv_from_tangent;
    const cov::Mat2<double> uv_from_tangent{m[0][0], m[0][1], m[1][0], m[1][1]};
    const float uv_per_length =
        std::sqrt(0.5f * (sqr(m[0][0]) + sqr(m[0][1]) + sqr(m[1][0]) + sqr(m[1][1])));
    const float footprint_uv = footprint * uv_per_length;
    const MaterialTextures textures = scene.materials.textures(vertex.material);
    // The shape's alpha varies the light of the surface as its reflectance does.
    const TextureId alpha = scene.geometry.shapes()[vertex.hit.shape].description.alpha;
    const auto spectrum = [&](TextureId id) {
        return texture_spectrum(scene, spectra, id, vertex.hit, uv_from_tangent, footprint_uv);
    };
    const cov::Sym2<double> edges = spectrum(alpha);
    if (reflects) reflectance = spectrum(textures.reflectance) + edges;
    if (transmits) transmittance = spectrum(textures.transmittance) + edges;
}

namespace {

/// The image that varies what a vertex emits; -1: none does.
TextureId image_of_emission(const LitScene& scene, const PathVertex& vertex,
                            const ShapeDescription& shape) {
    if (vertex.material >= 0)
        if (const auto* unlit =
                std::get_if<UnlitMaterial>(&scene.materials.description(vertex.material).value))
            return unlit->colour;
    return shape.area_light < 0
               ? -1
               : scene.description.area_lights[static_cast<size_t>(shape.area_light)].image;
}

}  // namespace

cov::Sym2<double> emission_texture(const LitScene& scene, const TextureSpectra& spectra,
                                   const PathVertex& vertex, const Frame& tangent,
                                   float footprint) {
    const ShapeDescription& shape = scene.geometry.shapes()[vertex.hit.shape].description;
    const TextureId image = image_of_emission(scene, vertex, shape);
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
    return texture_spectrum(scene, spectra, image, vertex.hit, uv_from_tangent, footprint_uv) +
           texture_spectrum(scene, spectra, shape.alpha, vertex.hit, uv_from_tangent, footprint_uv);
}

}  // namespace covtrace
