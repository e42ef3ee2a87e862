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

/// Even light that meets a flat surface above this cosine stays even: what the cosine and masking
/// make of it is at most 1.1 cycles per radian wide, 1/(pi 0.3), and the widest filter, of 15
/// pixels, passes as much at a hundred pixels per radian.
constexpr double kEvenCosine = 0.3;

/// The same from all places and directions, at all times.
bool is_even(const LightField& field) {
    return cov::trace(field.sigma) == 0;
}

LocalAxes local_axes(const Frame& shading, const cov::Frame<double>& f) {
    const cov::Vec3<double> x(shading.x), y(shading.y), z(shading.z);
    const auto local = [&](const cov::Vec3<double>& v) -> cov::Vec3<double> {
        return {cov::dot(v, x), cov::dot(v, y), cov::dot(v, z)};
    };
    return {local(f.x), local(f.y), local(f.z)};
}

/// Window of what a coat lets through around the direction of a ray: its transmission T as a
/// function of the cosine alone, which is c + u x.z + v y.z - c (u^2 + v^2)/2 in the ray's slopes.
cov::Sym2<double> coat_window(const LobeShare& lobe, const ScatterPoint& p,
                              const cov::Frame<double>& f) {
    const cov::Vec3<double> n(p.shading.z);
    const double z = cov::dot(f.z, n), c = std::abs(z);
    if (lobe.border_eta > 1 && c > kEvenTransmission) return {};
    const cov::Sym2<double> limit = cov::cosine_window<double>(f, p.facing.n);
    const auto t = 1 - border_reflectance(lobe, cov::Taylor<double>{c, 1, 0});
    if (!(t.value > 0)) return limit;
    const double l1 = t.first / t.value, l2 = t.second / t.value - l1 * l1;
    const double sign = z < 0 ? -1 : 1, x = sign * cov::dot(f.x, n), y = sign * cov::dot(f.y, n);
    return cov::local_lobe_of_log<double>(
        {0, l1 * x, l1 * y, l2 * x * x - l1 * c, l2 * x * y, l2 * y * y - l1 * c}, limit);
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
    if (rule == BrdfCovariance::local && p.is_flat && is_even(entered) &&
        std::abs(cov::dot(entered.frame.z, p.facing.n)) > kEvenCosine)
        return {{}, cov::frame_along<double>(p.outgoing)};
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

constexpr unsigned bit(LobeKind kind) {
    return 1u << static_cast<unsigned>(kind);
}

/// Bits of the lobes that the recorded events have.
unsigned kinds_of_lobes(const PathVertex& vertex) {
    unsigned kinds = 0;
    const auto collect = [&kinds](const LobeShares& shares) {
        for (size_t i = 0; i < size_t(shares.count); ++i) kinds |= bit(shares.lobes[i].kind);
    };
    if (vertex.direct > 0) collect(vertex.direct_event.lobes);
    if (vertex.scatters) collect(vertex.next_event.lobes);
    return kinds;
}

}  // namespace

ScatterPoint::ScatterPoint(const RenderScene& scene, const PathVertex& vertex, float footprint)
    : shading(vertex.shading), outgoing(vertex.wo) {
    const DifferentialGeometry d = scene.geometry.differential(vertex.hit);
    surface = {d.tangent.z, d.tangent.x, d.tangent.y, {d.k11, d.k12, d.k22}};
    normals = cov::normal_field(surface);
    facing = surface;
    if (scene.materials.has_normal_map(vertex.material)) {
        const NormalMap map(scene.materials.description(vertex.material), scene.textures,
                            scene.geometry.shapes()[vertex.hit.shape], vertex.hit, d, footprint);
        // Positions stay on the geometry; the normal turns by both shape operators.
        const Frame turned = Frame::from_z_x(vertex.shading.z, d.tangent.x);
        const auto [k11, k12, k22] = map.curvature();
        normals = {turned.z, turned.x * (d.k11 + k11) + turned.y * (d.k12 + k12),
                   turned.x * (d.k12 + k12) + turned.y * (d.k22 + k22)};
        facing = cov::shading_surface(surface, normals);
    }
    motion = {d.velocity, d.angular_velocity};
    is_flat = normals.is_flat() && motion.at_rest();
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
    // What alpha lets stand of the surface varies like its reflectance.
    const TextureId alpha = scene.geometry.shapes()[vertex.hit.shape].description.alpha;
    const auto spectrum = [&](TextureId id) {
        return texture_spectrum(scene, id, vertex.hit, uv_from_tangent, footprint_uv);
    };
    const cov::Sym2<double> edges = spectrum(alpha);
    if (reflects) reflectance = spectrum(textures.reflectance) + edges;
    if (transmits) transmittance = spectrum(textures.transmittance) + edges;
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

LightField ScatterSum::through_diffuse(const LightField& entered,
                                       const cov::Emitter<double>& emitter, const LobeShare& lobe,
                                       BrdfCovariance rule) {
    const ScatterPoint& p = point_;
    const cov::Sym2<double>& texture = is_transmission(lobe.kind) ? p.transmittance : p.reflectance;
    // Below a coat the diffuse lobe is a product: what the coat lets in from each direction, and
    // what it lets out.
    const bool coated = rule == BrdfCovariance::local && lobe.border_eta > 0;
    LightField left{{}, cov::frame_along<double>(p.outgoing)};
    if (!is_even(entered)) {
        // cov::reflect_diffuse with the coat's window.
        cov::Sym2<double> angular = entered.sigma.angular();
        if (coated) angular = angular + coat_window(lobe, p, entered.frame);
        left.sigma = entered.sigma;
        left.sigma.set_angular(angular +
                               cov::diffuse_window(entered.frame, p.facing, emitter, angular));
        left.sigma = cov::slice_angular(left.sigma);
    }
    left.sigma.set_spatial(left.sigma.spatial() + texture);
    if (!coated) return left;
    if (let_out_.eta != lobe.border_eta)
        let_out_ = {lobe.border_eta, coat_window(lobe, p, left.frame)};
    left.sigma.set_angular(left.sigma.angular() + let_out_.window);
    return left;
}

LightField ScatterSum::through(const LightField& entered, const cov::Emitter<double>& emitter,
                               const LobeShare& lobe, BrdfCovariance rule) {
    switch (lobe.kind) {
        case LobeKind::specular_reflection:
            return cov::reflect_specular<double>(entered, point_.facing, point_.outgoing);
        case LobeKind::specular_transmission:
            return cov::refract<double>(entered, point_.facing, point_.outgoing, lobe.eta, 1);
        case LobeKind::diffuse_reflection:
        case LobeKind::diffuse_transmission:
            return through_diffuse(entered, emitter, lobe, rule);
        case LobeKind::glossy_reflection:
        case LobeKind::glossy_transmission:
            break;
    }
    return through_glossy(entered, point_, lobe, rule);
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
    LightField entered = arriving;
    if (!is_even(arriving)) {
        if (!point_.motion.at_rest()) entered = cov::motion_enter(entered, point_.motion);
        entered.sigma = cov::change_positions<double>(
            entered.sigma, cov::surface_projection<double>(entered.frame, point_.surface),
            cov::surface_curvature<double>(entered.frame, point_.normals));
    }
    for (size_t i = 0; i < size_t(lobes.count); ++i)
        if (weights[i] > 0)
            add(through(entered, emitter, lobes.lobes[i], rule), weight * (weights[i] / kept));
}

void ScatterSum::add(const LightField& left, double weight) {
    if (!(weight_ > 0)) {
        left_ = left;
        weight_ = weight;
        return;
    }
    weight_ += weight;
    const double share = weight / weight_;
    // Positions are along the tangents for all; only slopes have axes of their own.
    const cov::Frame<double>&from = left.frame, &to = left_.frame;
    const bool is_turned =
        !(from.x == to.x && from.y == to.y) && !(left.sigma.angular() == cov::Sym2<double>{});
    const auto turned = [&] {
        return is_turned ? cov::map_angular(left.sigma, cov::projection<double>(from, to.x, to.y))
                         : left.sigma;
    };
    left_.sigma = (1 - share) * left_.sigma + share * turned();
}

LightField ScatterSum::leaving() const {
    if (is_even(left_)) return left_;
    const auto left = cov::surface_exit<double>(left_, point_.surface, point_.normals);
    return point_.motion.at_rest() ? left : cov::motion_exit(left, point_.motion);
}

}  // namespace covtrace
