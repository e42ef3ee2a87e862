#include "frequency/scatter.h"

#include <algorithm>
#include <cmath>

#include "shading/lobe_function.h"
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

/// Above this cosine what a denser coat lets through is even: second derivatives of Fresnel's
/// factor give a window of at most a seventh of the cosine's.
constexpr double kEvenTransmission = 0.7;

/// The axes of a ray in the coordinates of the BSDF.
struct Axes {
    cov::Vec3<double> x, y, z;

    Axes(const Frame& shading, const cov::Frame<double>& f)
        : x(local(shading, f.x)), y(local(shading, f.y)), z(local(shading, f.z)) {}

  private:
    static cov::Vec3<double> local(const Frame& f, const cov::Vec3<double>& v) {
        const auto along = [&](const Vec3& a) { return cov::dot(v, cov::Vec3<double>(a)); };
        return {along(f.x), along(f.y), along(f.z)};
    }
};

LightField through_diffuse(const LightField& entered, const cov::Emitter<double>& emitter,
                           const ScatterPoint& p, const LobeShare& lobe, BrdfCovariance rule) {
    const cov::Sym2<double>& texture = is_transmission(lobe.kind) ? p.transmittance : p.reflectance;
    const auto left = [&](const LightField& field) {
        return cov::add_texture(cov::reflect_diffuse(field, p.facing, p.outgoing, emitter),
                                texture);
    };
    if (rule == BrdfCovariance::global || !(lobe.border_eta > 0)) return left(entered);
    // Below a coat the diffuse lobe is a product: what the coat lets in from each direction, and
    // what it lets out.
    const auto transmission = [&](const cov::Frame<double>& f) -> cov::Sym2<double> {
        const Axes axes(p.shading, f);
        if (lobe.border_eta > 1 && std::abs(axes.z.z) > kEvenTransmission) return {};
        const auto direction = cov::jet_direction<double>(axes.x, axes.y, axes.z);
        return cov::local_lobe<double>(1 - border_reflectance(lobe, abs(direction.z)),
                                       cov::cosine_window<double>(f, p.facing.n));
    };
    const LightField field = left(cov::add_angular_window(entered, transmission(entered.frame)));
    return cov::add_angular_window(field, transmission(field.frame));
}

/// Through a lobe of GGX's slopes, which are distributed like cov::tailed_lobe.
LightField scatter_tailed(const LightField& field, const cov::GlossyPair<double>& pair) {
    const auto left = cov::map_angular(field.sigma, pair.map);
    const double size = cov::trace(pair.lobe);
    const bool is_peaked = cov::det(pair.lobe) > 1e-9 * size * size;
    const auto lobe = is_peaked ? cov::tailed_lobe(pair.lobe, left.angular()) : pair.lobe;
    return {cov::convolve_angular(left, lobe), pair.outgoing};
}

LightField through_glossy(const LightField& entered, const ScatterPoint& p, const LobeShare& lobe,
                          BrdfCovariance rule) {
    const auto micro = cov::micro_ggx<double>(lobe.alpha_x, lobe.alpha_y);
    const bool reflects = lobe.kind == LobeKind::glossy_reflection;
    const cov::GlossyPair<double> pair =
        reflects
            ? cov::reflection_pair<double>(entered.frame, p.facing, p.outgoing, micro)
            : cov::refraction_pair<double>(entered.frame, p.facing, p.outgoing, lobe.eta, 1, micro);
    if (rule == BrdfCovariance::global) {
        const bool wide = std::max(lobe.alpha_x, lobe.alpha_y) > kWideLobe;
        const LightField windowed = wide ? cov::add_cosine_window(entered, p.facing) : entered;
        return reflects ? scatter_tailed(windowed, pair) : cov::scatter(windowed, pair);
    }
    // Distribution and Fresnel are functions of the half vector: what they do to the arriving
    // slopes is in the lobe already, and the window is left with masking, at half the price of
    // cov::local_lobe for any BRDF.
    const Axes in(p.shading, entered.frame), out(p.shading, pair.outgoing);
    const auto leaving =
        lobe_function(lobe, cov::jet_direction<double>(out.x, out.y, out.z), -in.z);
    const auto arriving =
        masked_cosine(lobe, out.z, cov::jet_direction<double>(-in.x, -in.y, -in.z)) *
        cov::jet_solid_angle<double>();
    const cov::Sym2<double> window =
        cov::limited_by(cov::positive_part(cov::log_curvature(arriving)),
                        cov::cosine_window<double>(entered.frame, p.facing.n));
    const LightField windowed = cov::add_angular_window(entered, window);
    const cov::GlossyPair<double> local{pair.outgoing, pair.map,
                                        cov::local_lobe<double>(leaving, pair.lobe)};
    return reflects ? scatter_tailed(windowed, local) : cov::scatter(windowed, local);
}

bool has_lobe(const PathVertex& vertex, LobeKind kind) {
    const auto has = [kind](const LobeShares& shares) {
        const auto* end = shares.lobes.begin() + shares.count;
        return std::any_of(shares.lobes.begin(), end,
                           [kind](const LobeShare& l) { return l.kind == kind; });
    };
    return (vertex.direct > 0 && has(vertex.direct_event.lobes)) ||
           (vertex.scatters && has(vertex.next_event.lobes));
}

LightField through_lobe(const LightField& entered, const cov::Emitter<double>& emitter,
                        const ScatterPoint& p, const LobeShare& lobe, BrdfCovariance rule) {
    switch (lobe.kind) {
        case LobeKind::specular_reflection:
            return cov::reflect_specular<double>(entered, p.facing, p.outgoing);
        case LobeKind::specular_transmission:
            return cov::refract<double>(entered, p.facing, p.outgoing, lobe.eta, 1);
        case LobeKind::diffuse_reflection:
        case LobeKind::diffuse_transmission:
            return through_diffuse(entered, emitter, p, lobe, rule);
        case LobeKind::glossy_reflection:
        case LobeKind::glossy_transmission:
            break;
    }
    return through_glossy(entered, p, lobe, rule);
}

}  // namespace

ScatterPoint scatter_point(const RenderScene& scene, const PathVertex& vertex, float footprint) {
    const DifferentialGeometry d = scene.geometry.differential(vertex.hit);
    ScatterPoint p;
    p.surface = {d.tangent.z, d.tangent.x, d.tangent.y, {d.k11, d.k12, d.k22}};
    p.normals = cov::normal_field(p.surface);
    p.facing = p.surface;
    if (scene.materials.has_normal_map(vertex.material)) {
        const NormalMap map(scene.materials.description(vertex.material), scene.textures,
                            scene.geometry.shapes()[vertex.hit.shape], vertex.hit, d, footprint);
        // Positions stay on the geometry; the normal turns by both shape operators.
        const Frame turned = Frame::from_z_x(vertex.shading.z, d.tangent.x);
        const auto [k11, k12, k22] = map.curvature();
        p.normals = {turned.z, turned.x * (d.k11 + k11) + turned.y * (d.k12 + k12),
                     turned.x * (d.k12 + k12) + turned.y * (d.k22 + k22)};
        p.facing = cov::shading_surface(p.surface, p.normals);
    }
    p.motion = {d.velocity, d.angular_velocity};
    p.shading = vertex.shading;
    p.outgoing = vertex.wo;
    const bool reflects = has_lobe(vertex, LobeKind::diffuse_reflection),
               transmits = has_lobe(vertex, LobeKind::diffuse_transmission);
    if (!reflects && !transmits) return p;
    const auto& m = d.uv_from_tangent;
    const cov::Mat2<double> uv_from_tangent{m[0][0], m[0][1], m[1][0], m[1][1]};
    const float uv_per_length =
        std::sqrt(0.5f * (sqr(m[0][0]) + sqr(m[0][1]) + sqr(m[1][0]) + sqr(m[1][1])));
    const float footprint_uv = footprint * uv_per_length;
    const MaterialTextures textures = scene.materials.textures(vertex.material);
    // What alpha lets stand of the surface varies like its reflectance.
    const TextureId alpha = scene.geometry.shapes()[vertex.hit.shape].description.alpha;
    const auto spectrum = [&](TextureId id) {
        return texture_spectrum(scene, id, vertex.hit, uv_from_tangent, footprint_uv);
    };
    const cov::Sym2<double> edges = spectrum(alpha);
    if (reflects) p.reflectance = spectrum(textures.reflectance) + edges;
    if (transmits) p.transmittance = spectrum(textures.transmittance) + edges;
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

LightField scatter(const LightField& arriving, const cov::Emitter<double>& emitter,
                   const ScatterPoint& point, const LobeShares& lobes, BrdfCovariance rule,
                   double least) {
    const LightField entered = cov::surface_enter<double>(cov::motion_enter(arriving, point.motion),
                                                          point.surface, point.normals);
    double all = 0, most = 0;
    for (int i = 0; i < lobes.count; ++i) {
        const double weight = luminance(lobes.lobes[size_t(i)].value);
        all += weight;
        most = std::max(most, weight);
    }
    LightField sum;
    double total = 0;
    for (int i = 0; i < lobes.count; ++i) {
        const LobeShare& lobe = lobes.lobes[size_t(i)];
        const double weight = luminance(lobe.value);
        if (!(weight > 0) || (weight < least * all && weight < most)) continue;
        const LightField left = cov::surface_exit<double>(
            through_lobe(entered, emitter, point, lobe, rule), point.surface, point.normals);
        const LightField outside = cov::motion_exit(left, point.motion);
        sum = total > 0 ? cov::merge(sum, total, outside, weight) : outside;
        total += weight;
    }
    if (!(total > 0)) sum.frame = cov::frame_along<double>(point.outgoing);
    return sum;
}

}  // namespace covtrace
