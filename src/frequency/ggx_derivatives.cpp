#include "frequency/ggx_derivatives.h"

#include <cmath>

#include "frequency/fresnel_derivatives.h"

namespace covtrace {

namespace cov = covariance;

namespace {

using Vec = cov::Vec3<double>;
using Jet = cov::Jet<double>;

/// The matrix diag(x, y, 1).
struct Stretch {
    double x, y;
    Vec operator*(const Vec& v) const { return {x * v.x, y * v.y, v.z}; }
};

void upend(LocalAxes& a) {
    a.x.z = -a.x.z;
    a.y.z = -a.y.z;
    a.z.z = -a.z.z;
}

/// Adds s log g to a sum, with g to second order.
void add_log(Jet& sum, double s, const Jet& g) {
    const double i = 1 / g.value, u = g.u * i, v = g.v * i;
    sum.u += s * u;
    sum.v += s * v;
    sum.uu += s * (g.uu * i - u * u);
    sum.uv += s * (g.uv * i - u * v);
    sum.vv += s * (g.vv * i - v * v);
}

/// The function s(W) a + W.z b with W = z + u x + v y and s^2 = W.(S W): the denominator of Smith's
/// masking of both directions, where lengths cancel against the numerator.
Jet masking(const LocalAxes& w, const Stretch& stretch, double a, double b) {
    const Vec sz = stretch * w.z, sx = stretch * w.x;
    const double s = std::sqrt(dot(w.z, sz)), i = 1 / s;
    const double u = dot(w.x, sz) * i, v = dot(w.y, sz) * i;
    return {a * s + b * w.z.z,
            a * u + b * w.x.z,
            a * v + b * w.y.z,
            a * i * (dot(w.x, sx) - u * u),
            a * i * (dot(w.y, sx) - u * v),
            a * i * (dot(w.y, stretch * w.y) - v * v)};
}

}  // namespace

std::optional<Jet> log_reflection(const LobeShare& lobe, LocalAxes wo, Vec wi) {
    if (wo.z.z < 0) {
        upend(wo);
        wi.z = -wi.z;
    }
    if (!(wi.z > 0)) return std::nullopt;
    Jet sum;
    // Add the distribution at h = W + |W| wi, of any length: twice log |h|^2 / h.(A h)
    const Stretch narrow{1 / (double(lobe.alpha_x) * lobe.alpha_x),
                         1 / (double(lobe.alpha_y) * lobe.alpha_y)};
    const Vec h = wo.z + wi, ah = narrow * h, ax = narrow * wo.x;
    const double cu = dot(wo.x, wi), cv = dot(wo.y, wi), c = dot(wo.z, wi);
    const double turn = 2 + 2 * dot(h, wi), bend = 2 * dot(wi, ah);
    add_log(sum, 2, {dot(h, h), 2 * cu, 2 * cv, turn, 0, turn});
    add_log(sum, -2,
            {dot(h, ah), 2 * dot(wo.x, ah), 2 * dot(wo.y, ah), 2 * dot(wo.x, ax) + bend,
             2 * dot(wo.y, ax), 2 * dot(wo.y, narrow * wo.y) + bend});
    // Add masking, over cos(wo): lengths leave |W|
    const Stretch wide{double(lobe.alpha_x) * lobe.alpha_x, double(lobe.alpha_y) * lobe.alpha_y};
    add_log(sum, -1, masking(wo, wide, wi.z, std::sqrt(dot(wi, wide * wi))));
    sum.uu += 1;
    sum.vv += 1;
    if (!lobe.has_border()) return sum;
    // Add Fresnel's factor of x = cos(wo, h), x^2 = (1 + c) / 2 with c = wo.wi
    const double x = std::sqrt(0.5 * (1 + c)), x1 = 0.25 / x, x2 = -x1 * x1 / x;
    const auto r = reflectance_at(lobe, x);
    if (!(r.value > 0)) return std::nullopt;
    const double l1 = r.first / r.value, l2 = r.second / r.value - l1 * l1;
    const double g1 = l1 * x1, g2 = l1 * x2 + l2 * x1 * x1;
    sum.u += g1 * cu;
    sum.v += g1 * cv;
    sum.uu += g2 * cu * cu - g1 * c;
    sum.uv += g2 * cu * cv;
    sum.vv += g2 * cv * cv - g1 * c;
    return sum;
}

Jet log_masked_cosine(const LobeShare& lobe, Vec wo, LocalAxes wi) {
    if (wi.z.z < 0) upend(wi);
    const Stretch wide{double(lobe.alpha_x) * lobe.alpha_x, double(lobe.alpha_y) * lobe.alpha_y};
    Jet sum{0, 0, 0, -3, 0, -3};  // the solid angle, (1 + u^2 + v^2)^(-3/2)
    add_log(sum, 1, {wi.z.z, wi.x.z, wi.y.z, 0, 0, 0});
    add_log(sum, -1, masking(wi, wide, std::abs(wo.z), std::sqrt(dot(wo, wide * wo))));
    return sum;
}

}  // namespace covtrace
