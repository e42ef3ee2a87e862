#include "frequency/scatter.h"

#include <algorithm>
#include <cmath>

#include "frequency/ggx_derivatives.h"
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

LocalAxes local_axes(const Frame& shading, const cov::Frame<double>& f) {
    const cov::Vec3<double> x(shading.x), y(shading.y), z(shading.z);
    const auto local = [&](const cov::Vec3<double>& v) -> cov::Vec3<double> {
        return {cov::dot(v, x), cov::dot(v, y), cov::dot(v, z)};
    };
    return {local(f.x), local(f.y), local(f.z)};
}

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
        const double cosine = cov::dot(f.z, cov::Vec3<double>(p.shading.z));
        if (lobe.border_eta > 1 && std::abs(cosine) > kEvenTransmission) return {};
        const LocalAxes axes = local_axes(p.shading, f);
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

/// The lobe's covariance at the actual pair of directions.
cov::Sym2<double> local_lobe_at(const LobeShare& lobe, const LocalAxes& in, const LocalAxes& out,
                                const cov::Sym2<double>& peak) {
    if (lobe.kind == LobeKind::glossy_reflection) {
        const auto l = log_reflection(lobe, out, -in.z);
        return l ? cov::local_lobe_of_log(*l, peak) : peak;
    }
    return cov::local_lobe(
        lobe_function(lobe, cov::jet_direction<double>(out.x, out.y, out.z), -in.z), peak);
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
    const LocalAxes in = local_axes(p.shading, entered.frame),
                    out = local_axes(p.shading, pair.outgoing);
    const cov::Jet<double> arriving = log_masked_cosine(lobe, out.z, {-in.x, -in.y, -in.z});
    const cov::Sym2<double> window =
        cov::limited_by(cov::positive_part(cov::curvature_of_log(arriving)),
                        cov::cosine_window<double>(entered.frame, p.facing.n));
    const LightField windowed = cov::add_angular_window(entered, window);
    const cov::GlossyPair<double> local{pair.outgoing, pair.map,
                                        local_lobe_at(lobe, in, out, pair.lobe)};
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

void ScatterSum::add(const LightField& arriving, const cov::Emitter<double>& emitter,
                     const LobeShares& lobes, double weight, BrdfCovariance rule, double least) {
    double all = 0, most = 0;
    std::array<double, std::tuple_size_v<decltype(lobes.lobes)>> weights;
    for (size_t i = 0; i < size_t(lobes.count); ++i) {
        weights[i] = luminance(lobes.lobes[i].value);
        all += weights[i];
        most = std::max(most, weights[i]);
    }
    double kept = 0;
    for (size_t i = 0; i < size_t(lobes.count); ++i) {
        if (weights[i] < least * all && weights[i] < most) weights[i] = 0;
        kept += std::max(weights[i], 0.0);
    }
    if (!(kept > 0)) return add({{}, cov::frame_along<double>(point_.outgoing)}, weight);
    const LightField entered = cov::surface_enter<double>(
        cov::motion_enter(arriving, point_.motion), point_.surface, point_.normals);
    for (size_t i = 0; i < size_t(lobes.count); ++i)
        if (weights[i] > 0)
            add(through_lobe(entered, emitter, point_, lobes.lobes[i], rule),
                weight * (weights[i] / kept));
}

void ScatterSum::add(const LightField& left, double weight) {
    if (!(weight_ > 0)) {
        left_ = left;
        weight_ = weight;
        return;
    }
    // Positions are along the tangents for all; only slopes have axes of their own.
    const auto turned = cov::map_angular(
        left.sigma, cov::projection<double>(left.frame, left_.frame.x, left_.frame.y));
    weight_ += weight;
    const double share = weight / weight_;
    left_.sigma = (1 - share) * left_.sigma + share * turned;
}

LightField ScatterSum::leaving() const {
    return cov::motion_exit(cov::surface_exit<double>(left_, point_.surface, point_.normals),
                            point_.motion);
}

}  // namespace covtrace
