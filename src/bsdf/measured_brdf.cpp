#include "bsdf/measured_brdf.h"

#include <algorithm>
#include <cmath>

#include "bsdf/models.h"

namespace covtrace {

namespace {

// The square's coordinates of a direction
float u_of_theta(float theta) {
    return std::sqrt(theta * (2 / kPi));
}
float v_of_phi(float phi) {
    const float v = phi / (2 * kPi) + 0.5f;
    return v - std::floor(v);
}
float theta_of(Vec3 w) {
    // Exact near the pole, where acos is not
    return 2 * std::atan2(std::hypot(w.x, w.y), 1 + w.z);
}
float phi_of(Vec3 w) {
    return std::atan2(w.y, w.x);
}

/// Solid angle of the normals in an area of the square: of one whose coordinate is u and the sine
/// of whose angle is `sine`.
float solid_angle_per_area(float u, float sine) {
    return std::max(2 * kPi * kPi * u * sine, 1e-6f);
}

/// Sum of weight * value over the corners of the cell that a place lies in.
template <typename T>
T interpolated(const BrdfTables<T>& tables, size_t table, Vec2 place) {
    const auto w = size_t(tables.width), h = size_t(tables.height);
    const float x = clamp01(place.x) * float(w - 1), y = clamp01(place.y) * float(h - 1);
    const size_t i = std::min(size_t(x), w - 2), j = std::min(size_t(y), h - 2);
    const float s = x - float(i), t = y - float(j);
    const T* v = &tables.values[(table * h + j) * w + i];
    return (1 - t) * ((1 - s) * v[0] + s * v[1]) + t * ((1 - s) * v[w] + s * v[w + 1]);
}

/// The node at or below `value`, and the share of the next one.
struct Between {
    size_t node = 0;
    float share = 0;
};
Between between(const std::vector<float>& nodes, float value) {
    if (nodes.size() < 2) return {};
    const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, value);
    const auto i = size_t(above - nodes.begin()) - 1;
    return {i, clamp01((value - nodes[i]) / (nodes[i + 1] - nodes[i]))};
}

/// Roughness of the GGX distribution with this density of normals at the pole, D(0) = 1 / (pi
/// alpha^2) where the projected areas sum to 1.
float ggx_like(const BrdfTables<float>& normals) {
    constexpr int kSteps = 256;
    double projected = 0, at_pole = 0;
    for (int j = 0; j < kSteps; ++j) {
        const float v = (float(j) + 0.5f) / kSteps;
        at_pole += double(interpolated(normals, 0, {0, v})) / kSteps;
        for (int i = 0; i < kSteps; ++i) {
            const float u = (float(i) + 0.5f) / kSteps, theta = u * u * (kPi / 2);
            projected += double(interpolated(normals, 0, {u, v}) * std::cos(theta) *
                                solid_angle_per_area(u, std::sin(theta))) /
                         (double(kSteps) * kSteps);
        }
    }
    return at_pole > 0 ? std::clamp(float(std::sqrt(projected / (kPi * at_pole))), 1e-3f, 1.0f)
                       : 1.0f;
}

}  // namespace

MeasuredBrdf::MeasuredBrdf(const BrdfTensor& t)
    : phi_(t.phi),
      theta_(t.theta),
      is_isotropic_(t.is_isotropic()),
      normals_(t.normals),
      areas_(t.areas),
      visible_normals_(t.visible_normals.width, t.visible_normals.height, t.visible_normals.values),
      luminance_(t.luminance.width, t.luminance.height, t.luminance.values),
      colours_(t.colours),
      alpha_(ggx_like(t.normals)) {
    // The albedo is the mean weight of samples, over a few azimuths
    constexpr int kSide = 16, kAzimuths = 4;
    for (const float theta : theta_) {
        Rgb sum;
        for (int k = 0; k < kAzimuths; ++k) {
            const float phi = 2 * kPi * (float(k) + 0.5f) / kAzimuths;
            const float cosine = std::max(std::cos(theta), 1e-3f), sine = std::sin(theta);
            const Vec3 wo = normalize(Vec3{sine * std::cos(phi), sine * std::sin(phi), cosine});
            for (int i = 0; i < kSide * kSide; ++i) {
                const Vec2 u{(float(i % kSide) + 0.5f) / kSide, (float(i / kSide) + 0.5f) / kSide};
                if (const auto s = sample(wo, u)) sum += s->weight;
            }
        }
        const Rgb mean = sum / float(kAzimuths * kSide * kSide);
        albedo_.push_back({clamp01(mean.r), clamp01(mean.g), clamp01(mean.b)});
    }
}

MeasuredBrdf::View MeasuredBrdf::view(Vec3 wo) const {
    View v{phi_of(wo), theta_of(wo), {}};
    const Between p = between(phi_, v.phi), t = between(theta_, v.theta);
    for (const size_t i : {0, 1})
        for (const size_t j : {0, 1}) {
            const float weight = (i ? p.share : 1 - p.share) * (j ? t.share : 1 - t.share);
            if (!(weight > 0)) continue;
            const auto k = size_t(v.weights.count++);
            v.weights.table[k] = (p.node + i) * theta_.size() + t.node + j;
            v.weights.weight[k] = weight;
        }
    return v;
}

Vec2 MeasuredBrdf::place_of(Vec3 normal, const View& view) const {
    const float phi = phi_of(normal) - (is_isotropic_ ? view.phi : 0);
    return {u_of_theta(theta_of(normal)), v_of_phi(phi)};
}

Rgb MeasuredBrdf::value(Vec2 normal, Vec2 place, const View& view) const {
    Rgb factor;
    for (size_t k = 0; k < size_t(view.weights.count); ++k)
        factor += view.weights.weight[k] * interpolated(colours_, view.weights.table[k], place);
    const float area = interpolated(areas_, 0, {u_of_theta(view.theta), v_of_phi(view.phi)});
    if (!(area > 0)) return {};
    const float scale = interpolated(normals_, 0, normal) / (4 * area);
    // Bright colours may be negative in one channel, and measurements are noisy
    return {std::max(0.0f, scale * factor.r), std::max(0.0f, scale * factor.g),
            std::max(0.0f, scale * factor.b)};
}

Rgb MeasuredBrdf::eval(Vec3 wo, Vec3 wi) const {
    const View v = view(wo);
    const Vec2 normal = place_of(normalize(wo + wi), v);
    return value(normal, visible_normals_.invert(normal, v.weights).place, v);
}

float MeasuredBrdf::pdf(Vec3 wo, Vec3 wi) const {
    const View v = view(wo);
    const Vec3 m = normalize(wo + wi);
    const Vec2 normal = place_of(m, v);
    const BilinearDensity::Sample place = visible_normals_.invert(normal, v.weights);
    return place.pdf * luminance_.pdf(place.place, v.weights) /
           (4 * dot(wo, m) * solid_angle_per_area(normal.x, std::hypot(m.x, m.y)));
}

std::optional<BsdfSample> MeasuredBrdf::sample(Vec3 wo, Vec2 u) const {
    const View v = view(wo);
    const BilinearDensity::Sample place = luminance_.sample(u, v.weights);
    const BilinearDensity::Sample normal = visible_normals_.sample(place.place, v.weights);
    const float theta = normal.place.x * normal.place.x * (kPi / 2);
    const float phi = (2 * normal.place.y - 1) * kPi + (is_isotropic_ ? v.phi : 0);
    const float sine = std::sin(theta);
    const Vec3 m{sine * std::cos(phi), sine * std::sin(phi), std::cos(theta)};
    const float cosine = dot(wo, m);
    const Vec3 wi = normalize(2 * cosine * m - wo);
    if (!(cosine > 0) || !(wi.z > 0)) return std::nullopt;
    const float pdf =
        place.pdf * normal.pdf / (4 * cosine * solid_angle_per_area(normal.place.x, sine));
    if (!(pdf > 0) || !std::isfinite(pdf)) return std::nullopt;
    const LobeKind kind = is_wide() ? LobeKind::diffuse_reflection : LobeKind::glossy_reflection;
    return BsdfSample{wi, value(normal.place, place.place, v) / pdf, pdf, kind};
}

Rgb MeasuredBrdf::albedo(Vec3 wo) const {
    const Between t = between(theta_, theta_of(wo));
    if (t.node + 1 >= albedo_.size()) return albedo_.empty() ? Rgb(0) : albedo_[t.node];
    return (1 - t.share) * albedo_[t.node] + t.share * albedo_[t.node + 1];
}

// ---- The model of bsdf.h

namespace {

/// A direction as if wo were above the surface: both sides look the same, turned about the x axis'
/// plane as in pbrt.
Vec3 upward(Vec3 w, Vec3 wo) {
    return wo.z < 0 ? -w : w;
}

}  // namespace

Rgb eval(const MeasuredBsdf& b, Vec3 wo, Vec3 wi) {
    return same_side(wo, wi) ? b.brdf->eval(upward(wo, wo), upward(wi, wo)) : Rgb(0);
}

float pdf(const MeasuredBsdf& b, Vec3 wo, Vec3 wi) {
    return same_side(wo, wi) ? b.brdf->pdf(upward(wo, wo), upward(wi, wo)) : 0;
}

std::optional<BsdfSample> sample(const MeasuredBsdf& b, Vec3 wo, float, Vec2 u) {
    auto s = b.brdf->sample(upward(wo, wo), u);
    if (s) s->wi = upward(s->wi, wo);
    return s;
}

LobeShares lobe_shares(const MeasuredBsdf& b, Vec3 wo, Vec3 wi, Rgb value) {
    if (!same_side(wo, wi)) return {};
    LobeShare lobe;
    lobe.value = value;
    lobe.kind = LobeKind::diffuse_reflection;
    if (!b.brdf->is_wide()) {
        lobe.kind = LobeKind::glossy_reflection;
        lobe.alpha_x = lobe.alpha_y = b.brdf->alpha();
    }
    LobeShares shares;
    shares.lobes[0] = lobe;
    shares.count = 1;
    return shares;
}

Rgb albedo(const MeasuredBsdf& b, Vec3 wo) {
    return b.brdf->albedo(upward(wo, wo));
}

}  // namespace covtrace
