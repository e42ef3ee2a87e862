#include "frequency/scatter.h"

#include <algorithm>
#include <cmath>

#include "bsdf/lobe_function.h"
#include "frequency/fresnel_derivatives.h"
#include "frequency/ggx_derivatives.h"
#include "frequency/round_lobe.h"
#include "frequency/strand_lobe.h"

namespace covtrace {

namespace cov = covariance;

namespace {

/// Roughness from which on a lobe is so wide that it feels the horizon: the cosine limits it as it
/// limits a diffuse surface.
constexpr float kWideLobe = 0.4f;

/// Cosine above which a denser coat lets light through evenly: derivatives of the logarithm of
/// Fresnel's factor give a window of at most a quarter of the bandwidth of the cosine's (the most
/// is at an index of 1.8).
constexpr double kEvenTransmission = 0.7;

/// Cosine above which even light that meets a flat surface stays even: the window of cosine and
/// masking is at most 1.1 cycles per radian wide, 1/(pi 0.3), and the widest filter, of 15 pixels,
/// passes as much at a hundred pixels per radian.
constexpr double kEvenCosine = 0.3;

/// Whether light is the same from all places and directions, at all times.
bool is_even(const LightField& field) {
    return cov::trace(field.sigma) == 0;
}

/// The axes of a frame in the coordinates of the BSDF.
LocalAxes local_axes(const cov::Frame<double>& shading, const cov::Frame<double>& f) {
    const cov::Vec3<double>&x = shading.x, &y = shading.y, &z = shading.z;
    const auto local = [&](const cov::Vec3<double>& v) -> cov::Vec3<double> {
        return {cov::dot(v, x), cov::dot(v, y), cov::dot(v, z)};
    };
    return {local(f.x), local(f.y), local(f.z)};
}

/// Window of the light that a coat lets through around the direction of a ray: the coat's
/// transmission T as a function of the cosine alone, which is c + u (X.n) + v (Y.n) - c (u^2 +
/// v^2)/2 in the slopes u, v along the ray's axes X and Y, n the normal on the ray's side.
cov::Sym2<double> coat_window(const LobeShare& lobe, const ScatterPoint& p,
                              const cov::Frame<double>& f) {
    const cov::Vec3<double>& n = p.facing().n;
    const double z = cov::dot(f.z, n), c = std::abs(z);
    if (lobe.border_eta > 1 && c > kEvenTransmission) return {};
    const double nx = cov::dot(f.x, n), ny = cov::dot(f.y, n);
    const cov::Sym2<double> limit = cov::cosine_window<double>({nx, ny, z});
    const auto t = 1 - reflectance_at(lobe, c);
    if (!(t.value > 0)) return limit;
    const double i = 1 / t.value, l1 = t.first * i, l2 = t.second * i - l1 * l1;
    const double sign = z < 0 ? -1 : 1, x = sign * nx, y = sign * ny;
    return cov::local_lobe_of_log<double>(
        {0, l1 * x, l1 * y, l2 * x * x - l1 * c, l2 * x * y, l2 * y * y - l1 * c}, limit);
}

/// Covariance of a lobe of GGX's slopes for light of the angular covariance `light`. GGX has the
/// tails that cov::tailed_lobe is for; lobes that are flat along one axis stay as they are.
cov::Sym2<double> tailed(const cov::Sym2<double>& lobe, const cov::Sym2<double>& light) {
    const double size = cov::trace(lobe);
    const bool is_peaked = cov::det(lobe) > 1e-9 * size * size;
    return is_peaked ? cov::tailed_lobe(lobe, light) : lobe;
}

/// Reflects light by a lobe of GGX's slopes. The pair's map is not applied: that of a reflection is
/// the identity.
LightField reflect_tailed(const LightField& field, const cov::GlossyPair<double>& pair) {
    return {cov::convolve_angular(field.sigma, tailed(pair.lobe, field.sigma.angular())),
            pair.outgoing};
}

/// Covariance of the lobe at the actual pair of directions.
cov::Sym2<double> local_lobe_at(const LobeShare& lobe, const LocalAxes& in, const LocalAxes& out,
                                const cov::Sym2<double>& peak) {
    if (lobe.kind == LobeKind::glossy_reflection) {
        const auto l = log_reflection(lobe, out, -in.z);
        return l ? cov::local_lobe_of_log(*l, peak) : peak;
    }
    return cov::local_lobe(
        lobe_function(lobe, cov::jet_direction<double>(out.x, out.y, out.z), -in.z), peak);
}

/// Window of masking on the arriving light, from the derivatives of its logarithm.
cov::Sym2<double> masking_window(const cov::Jet<double>& log_masking,
                                 const cov::Sym2<double>& limit) {
    return cov::limited_by(cov::positive_part(cov::curvature_of_log(log_masking)), limit);
}

/// Reflects light by a lobe of one roughness, whose axes do not matter.
LightField reflect_round(const LightField& entered, const ScatterPoint& p, const LobeShare& lobe) {
    const bool is_turned = std::abs(lobe.normal.z) != 1;
    const RoundReflection round = round_reflection(
        lobe, entered.frame, p.leaving.z,
        is_turned ? cov::Vec3<double>(p.shading.to_world(lobe.normal)) : p.facing().n);
    LightField left{entered.sigma, round.outgoing};
    const cov::Sym2<double> light = left.sigma.angular() + round.window;
    left.sigma.set_angular(light);
    left.sigma = cov::convolve_angular(left.sigma, tailed(round.lobe, light));
    return left;
}

LightField through_glossy(const LightField& entered, const ScatterPoint& p, const LobeShare& lobe,
                          BrdfCovariance rule);

/// Lets light pass a rough pane: mirrored at its plane it is reflected by the lobe. The share that
/// passes a facet, 1 - 2R/(1 + R), is nearly even and has no window.
LightField through_pane(const LightField& entered, const ScatterPoint& p, LobeShare lobe,
                        BrdfCovariance rule) {
    lobe.kind = LobeKind::glossy_reflection;
    lobe.border_eta = 0;
    const cov::Vec3<double>& n = p.facing().n;
    const auto mirrored = [&n](const cov::Vec3<double>& v) -> cov::Vec3<double> {
        return v - 2 * cov::dot(v, n) * n;
    };
    const cov::Frame<double>& f = entered.frame;
    return through_glossy({entered.sigma, {mirrored(f.x), mirrored(f.y), mirrored(f.z)}}, p, lobe,
                          rule);
}

LightField through_glossy(const LightField& entered, const ScatterPoint& p, const LobeShare& lobe,
                          BrdfCovariance rule) {
    if (lobe.is_pane && lobe.kind == LobeKind::glossy_transmission)
        return through_pane(entered, p, lobe, rule);
    const bool reflects = lobe.kind == LobeKind::glossy_reflection;
    if (reflects && rule == BrdfCovariance::local && lobe.alpha_x == lobe.alpha_y)
        return reflect_round(entered, p, lobe);
    const auto micro = cov::micro_ggx<double>(lobe.alpha_x, lobe.alpha_y);
    const cov::GlossyPair<double> pair =
        reflects ? cov::reflection_pair<double>(entered.frame, p.facing(), p.leaving.z, micro)
                 : cov::refraction_pair<double>(entered.frame, p.facing(), p.leaving.z, lobe.eta, 1,
                                                micro);
    if (rule == BrdfCovariance::global) {
        const bool wide = std::max(lobe.alpha_x, lobe.alpha_y) > kWideLobe;
        const LightField windowed = wide ? cov::add_cosine_window(entered, p.facing()) : entered;
        return reflects ? reflect_tailed(windowed, pair) : cov::scatter(windowed, pair);
    }
    // Distribution and Fresnel are functions of the half vector: their effect on the arriving
    // slopes is in the lobe already, and the window is left with masking and the cosine. That takes
    // half the time of cov::local_lobe, which is for any BRDF.
    const cov::Frame<double> shading{p.shading.x, p.shading.y, p.shading.z};
    const LocalAxes in = local_axes(shading, entered.frame),
                    out = local_axes(shading, pair.outgoing);
    const cov::Jet<double> arriving = log_masked_cosine(lobe, out.z, {-in.x, -in.y, -in.z});
    const cov::Sym2<double> window =
        masking_window(arriving, cov::cosine_window<double>(entered.frame, p.facing().n));
    const LightField windowed = cov::add_angular_window(entered, window);
    const cov::GlossyPair<double> local{pair.outgoing, pair.map,
                                        local_lobe_at(lobe, in, out, pair.lobe)};
    return reflects ? reflect_tailed(windowed, local) : cov::scatter(windowed, local);
}

}  // namespace

void ScatterSum::add_diffuse(const LightField& entered, bool even,
                             const cov::Emitter<double>& emitter, const LobeShare& lobe,
                             double weight, BrdfCovariance rule) {
    weight_ += weight;
    (is_transmission(lobe.kind) ? transmitted_ : reflected_) += weight;
    // Below a coat the diffuse lobe is a product: the share that the coat lets in from each
    // direction, and the share that it lets out.
    const bool coated = rule == BrdfCovariance::local && lobe.border_eta > 0;
    if (coated) {
        if (coat_ && coat_->border_eta != lobe.border_eta) add_let_out();
        coat_ = &lobe;
        coated_ += weight;
    }
    if (even) return;
    // Add cov::reflect_diffuse with the coat's window
    cov::Sym2<double> angular = entered.sigma.angular();
    if (coated) angular = angular + coat_window(lobe, point_, entered.frame);
    const cov::Sym2<double> window =
        cov::diffuse_window(entered.frame, point_.facing(), emitter, angular);
    cov::add_scaled(sum_, weight, cov::slice_angular<double>(entered.sigma, angular + window));
}

void ScatterSum::add_sheen(const LightField& entered, bool even, const LobeShare& lobe,
                           double weight, BrdfCovariance rule) {
    weight_ += weight;
    const cov::Vec3<double>& n = point_.facing().n;
    const cov::Frame<double> shading{point_.shading.x, point_.shading.y, point_.shading.z};
    const LocalAxes in = local_axes(shading, entered.frame),
                    out = local_axes(shading, point_.leaving);
    const bool is_local = rule == BrdfCovariance::local;
    if (is_local) {
        const auto leaving = cov::jet_direction<double>(out.x, out.y, out.z);
        add_slopes(weight * cov::local_lobe<double>(lobe_function(lobe, leaving, -in.z),
                                                    cov::cosine_window(point_.leaving, n)),
                   point_.leaving);
    }
    if (even) return;
    const cov::Sym2<double> limit = cov::cosine_window(entered.frame, n);
    const auto arriving = cov::jet_direction<double>(-in.x, -in.y, -in.z);
    const cov::Sym2<double> window =
        is_local ? cov::local_lobe<double>(
                       lobe_function(lobe, cov::jet_constant<double>(out.z), arriving), limit)
                 : limit;
    cov::add_scaled(sum_, weight,
                    cov::slice_angular<double>(entered.sigma, entered.sigma.angular() + window));
}

void ScatterSum::add_let_out() {
    add_slopes(coated_ * coat_window(*coat_, point_, point_.leaving), point_.leaving);
    coated_ = 0;
}

void ScatterSum::add_through(const LightField& entered, bool even,
                             const cov::Emitter<double>& emitter, const LobeShare& lobe,
                             double weight, BrdfCovariance rule) {
    switch (lobe.kind) {
        case LobeKind::specular_reflection:
            return add(cov::reflect_specular<double>(entered, point_.facing(), point_.leaving.z),
                       weight);
        case LobeKind::specular_transmission:
            return add(
                cov::refract<double>(entered, point_.facing(), point_.leaving.z, lobe.eta, 1),
                weight);
        case LobeKind::diffuse_reflection:
        case LobeKind::diffuse_transmission:
            return add_diffuse(entered, even, emitter, lobe, weight, rule);
        case LobeKind::sheen_reflection:
            return add_sheen(entered, even, lobe, weight, rule);
        case LobeKind::hair_reflection:
        case LobeKind::hair_transmission:
            if (even)
                weight_ += weight;  // the light stays even
            else
                add(cov::scatter<double>(entered, strand_pair(lobe, point_.shading.x, entered.frame,
                                                              point_.leaving.z)),
                    weight);
            return;
        case LobeKind::glossy_reflection:
        case LobeKind::glossy_transmission:
            break;
    }
    if (even && rule == BrdfCovariance::local && !point_.normals && !point_.motion &&
        std::abs(cov::dot(entered.frame.z, point_.facing().n)) > kEvenCosine) {
        weight_ += weight;  // the light stays even
        return;
    }
    add(through_glossy(entered, point_, lobe, rule), weight);
}

LightField ScatterSum::enter(const LightField& arriving) const {
    const ScatterPoint& p = point_;
    if (p.motion) {
        const LightField resting = cov::motion_enter(arriving, *p.motion);
        return p.normals ? cov::surface_enter<double>(resting, p.surface, *p.normals)
                         : cov::surface_enter<double>(resting, p.surface);
    }
    if (p.normals) return cov::surface_enter<double>(arriving, p.surface, *p.normals);
    return {cov::change_positions<double>(
                arriving.sigma, cov::surface_projection<double>(arriving.frame, p.surface)),
            arriving.frame};
}

void ScatterSum::add(const LightField& arriving, const cov::Emitter<double>& emitter,
                     const LobeShares& lobes, double weight, BrdfCovariance rule, double least) {
    // Leave out faint lobes, and share their light among the others
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
    if (!(kept > 0)) {
        weight_ += weight;
        return;
    }
    // Send the light through each lobe that is left; even light need not enter the surface
    const double scale = weight / kept;
    const auto add_lobes = [&](const LightField& entered, bool even) {
        for (size_t i = 0; i < size_t(lobes.count); ++i)
            if (weights[i] > 0)
                add_through(entered, even, emitter, lobes.lobes[i], weights[i] * scale, rule);
    };
    if (is_even(arriving))
        add_lobes(arriving, true);
    else
        add_lobes(enter(arriving), false);
}

void ScatterSum::add(const LightField& left, double weight) {
    weight_ += weight;
    // Positions are along the surface's tangents for all light; only slopes have axes of their own.
    if (takes_slopes_of(left.frame))
        cov::add_scaled(sum_, weight, left.sigma);
    else
        cov::add_scaled(sum_, weight, cov::map_angular(left.sigma, to_own(left.frame)));
}

void ScatterSum::add_slopes(const cov::Sym2<double>& window, const cov::Frame<double>& frame) {
    if (cov::trace(window) == 0) return;
    sum_.set_angular(sum_.angular() +
                     (takes_slopes_of(frame) ? window : cov::congruence(window, to_own(frame))));
}

bool ScatterSum::takes_slopes_of(const cov::Frame<double>& frame) {
    if (has_slopes_) return frame.x == frame_.x && frame.y == frame_.y;
    frame_ = frame;
    has_slopes_ = true;
    return true;
}

cov::Mat2<double> ScatterSum::to_own(const cov::Frame<double>& frame) const {
    return cov::projection<double>(frame, frame_.x, frame_.y);
}

LightField ScatterSum::leaving() {
    const ScatterPoint& p = point_;
    if (coated_ > 0) add_let_out();
    sum_.set_spatial(sum_.spatial() + reflected_ * p.reflectance + transmitted_ * p.transmittance);
    if (cov::trace(sum_) == 0) return {{}, frame_};
    const auto mean = (1 / weight_) * sum_;
    if (!p.normals && !p.motion)
        return {
            cov::change_positions<double>(mean, cov::inverse_projection<double>(frame_, p.surface)),
            frame_};
    const LightField field{mean, frame_};
    const auto left = p.normals ? cov::surface_exit<double>(field, p.surface, *p.normals)
                                : cov::surface_exit<double>(field, p.surface);
    return p.motion ? cov::motion_exit(left, *p.motion) : left;
}

}  // namespace covtrace
