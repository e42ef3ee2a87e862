// Lobes at the actual pair of directions: jets against finite differences, closed forms, limits,
// and the purpose of local lobes: a scale on which the lobe may be smoothed, everywhere on it.
#include <functional>

#include "support.h"

namespace support {
namespace {

using namespace covariance;
using J = Jet<double>;
using JV = JetVec3<double>;

constexpr double kFourPiSq = four_pi_sq<double>;

// ---- derivatives

/// A function that is smooth, positive, and made of everything a jet knows.
template <typename S>
S everything(const S& u, const S& v) {
    using std::exp, std::log, std::pow, std::sqrt, std::abs;
    return sqrt(S(2.0) + u * v + v * v) / (S(1.5) + u) + exp(u - S(2.0) * v) * log(S(3.0) + v) -
           pow(S(1.2) + u * u, -1.5) + abs(u - S(5.0));
}

RC_GTEST_PROP(Jets, AgreeWithFiniteDifferences, ()) {
    const double u = draw(-0.9, 0.9), v = draw(-0.9, 0.9), h = 1e-4;
    const J jet = everything(J(u, 1, 0), J(v, 0, 1));
    const auto f = [&](double a, double b) { return everything(u + a * h, v + b * h); };
    RC_ASSERT(std::abs(jet.value - f(0, 0)) < 1e-14);
    RC_ASSERT(std::abs(jet.u - (f(1, 0) - f(-1, 0)) / (2 * h)) < 1e-5);
    RC_ASSERT(std::abs(jet.v - (f(0, 1) - f(0, -1)) / (2 * h)) < 1e-5);
    RC_ASSERT(std::abs(jet.uu - (f(1, 0) - 2 * f(0, 0) + f(-1, 0)) / (h * h)) < 1e-4);
    RC_ASSERT(std::abs(jet.vv - (f(0, 1) - 2 * f(0, 0) + f(0, -1)) / (h * h)) < 1e-4);
    RC_ASSERT(std::abs(jet.uv - (f(1, 1) - f(1, -1) - f(-1, 1) + f(-1, -1)) / (4 * h * h)) < 1e-4);
}

TEST(Jets, AreConstantExpressions) {
    constexpr J x(3, 1, 0), y(2, 0, 1);
    static_assert((x * y).uv == 1 && (x / y).v == -0.75 && (x * x).uu == 2 && y < x);
    static_assert((2.0 - x).u == -1 && abs(J(-1.0) * x).u == 1);
}

RC_GTEST_PROP(Jets, DirectionsAreThoseOfTheSlopes, ()) {
    const Frame f = draw_frame(draw_direction());
    const JV w = jet_direction<double>(f.x, f.y, f.z);
    const double u = draw(-1e-3, 1e-3), v = draw(-1e-3, 1e-3);
    const Vec3 exact = normalized_or(f.z + u * f.x + v * f.y, f.z);
    const auto at = [&](const J& j) {
        return j.value + j.u * u + j.v * v + j.uu * u * u / 2 + j.uv * u * v + j.vv * v * v / 2;
    };
    RC_ASSERT(length(Vec3{at(w.x), at(w.y), at(w.z)} - exact) < 1e-8);
}

// ---- a BRDF written once: anisotropic GGX with height-correlated masking, times the cosine

struct Rough {
    double ax = 0.2, ay = 0.4;

    template <typename V>
    auto stretched(const V& w) const {
        using std::sqrt;
        return sqrt(w.z * w.z + ax * ax * w.x * w.x + ay * ay * w.y * w.y);
    }
    template <typename V>
    auto operator()(const V& wi, const V& wo) const {
        const V h = wo + wi;  // of any length: the distribution does not ask for it
        const auto x = h.x / (ax * h.z), y = h.y / (ay * h.z);
        const auto e = 1.0 + x * x + y * y;
        const auto cos2 = h.z * h.z / dot(h, h);
        return 2.0 * wi.z / (stretched(wo) * wi.z + stretched(wi) * wo.z) / (cos2 * cos2 * e * e);
    }
};

Vec3 same(const Vec3& v) {
    return v;
}

/// Second derivatives of log f by central differences in slopes, over -4 pi^2.
Sym2 differences(const std::function<double(double, double)>& log_f, double h) {
    const auto f = [&](int a, int b) { return log_f(a * h, b * h); };
    const double s = -1 / (kFourPiSq * h * h);
    return {s * (f(1, 0) - 2 * f(0, 0) + f(-1, 0)),
            s * (f(1, 1) - f(1, -1) - f(-1, 1) + f(-1, -1)) / 4,
            s * (f(0, 1) - 2 * f(0, 0) + f(0, -1))};
}

RC_GTEST_PROP(LocalLobe, CurvatureIsThatOfFiniteDifferences, ()) {
    const Rough f{draw(0.05, 0.8), draw(0.05, 0.8)};
    const Surface flat;
    const Frame in = draw_frame(-draw_leaving(flat.n));
    const Frame out = draw_frame(draw_leaving(flat.n));
    const Sym2 leaving =
        log_curvature(f(jet_constant<double>(-in.z), jet_direction<double>(out.x, out.y, out.z)));
    const Sym2 expected = differences(
        [&](double u, double v) {
            return std::log(f(-in.z, normalized_or(out.z + u * out.x + v * out.y, out.z)));
        },
        1e-4);
    RC_ASSERT(distance(leaving, expected, 1) < 1e-4);
}

RC_GTEST_PROP(LocalLobe, OfANarrowLobeAtItsPeakIsTheGlobalOneWithoutAWindow, ()) {
    const Surface flat;
    const double ax = draw(0.002, 0.01), ay = draw(0.002, 0.01);
    const Frame in = draw_frame(-draw_leaving(flat.n));
    const Vec3 mirror = in.z - 2 * dot(in.z, flat.n) * flat.n;
    const auto pair = reflection_pair(in, flat, mirror, micro_ggx(ax, ay));
    const LocalLobe<double> local =
        local_lobe(Rough{ax, ay}, same, in, pair, cosine_window(in, flat.n));
    RC_ASSERT(distance(local.pair.lobe, pair.lobe) < 0.01);
    RC_ASSERT(trace(local.window) < 0.01 * trace(pair.lobe));
}

RC_GTEST_PROP(LocalLobe, OfANarrowRefractionIsTheGlobalOneWithoutAWindow, ()) {
    const Surface flat;
    const double a = draw(0.002, 0.01), n1 = draw(1, 1.6), n2 = draw(1, 1.6), eta = n1 / n2;
    const Frame in = draw_frame(-draw_leaving(flat.n));
    const double c1 = -in.z.z;
    RC_PRE(std::abs(n1 - n2) > 0.1 && eta * eta * (1 - c1 * c1) < 0.95);
    const double c2 = std::sqrt(1 - eta * eta * (1 - c1 * c1));
    const Vec3 out = eta * in.z + (eta * c1 - c2) * flat.n;
    // The distribution of the facets that refract, the sharp part of a rough border's BTDF.
    const auto facets = [&](const auto& wi, const auto& wo) {
        const auto x = n1 * wi.x + n2 * wo.x, y = n1 * wi.y + n2 * wo.y, z = n1 * wi.z + n2 * wo.z;
        const auto e = a * a * z * z + x * x + y * y;
        return z * z * z * z / (e * e);
    };
    const auto pair = refraction_pair(in, flat, out, n1, n2, micro_ggx(a, a));
    const auto local = local_lobe(facets, same, in, pair, Sym2::diagonal(1e9, 1e9));
    RC_ASSERT(distance(local.pair.lobe, pair.lobe) < 0.01);
    RC_ASSERT(trace(local.window) < 0.01 * trace(congruence(pair.lobe, inverse(pair.map))));
}

RC_GTEST_PROP(LocalLobe, IsPositiveAndNeverSharperThanThePeak, ()) {
    const Surface flat;
    const Rough f{draw(0.02, 1), draw(0.02, 1)};
    const Frame in = draw_frame(-draw_leaving(flat.n));
    const Vec3 out = draw_leaving(flat.n);
    const auto pair = reflection_pair(in, flat, out, micro_ggx(f.ax, f.ay));
    const Sym2 limit = cosine_window(in, flat.n);
    const LocalLobe<double> local = local_lobe(f, same, in, pair, limit);
    RC_ASSERT(is_psd(local.pair.lobe, trace(pair.lobe)));
    RC_ASSERT(is_psd(pair.lobe - local.pair.lobe, trace(pair.lobe)));
    RC_ASSERT(is_psd(local.window, trace(limit)));
    RC_ASSERT(is_psd(limit - local.window, trace(limit)));
}

RC_GTEST_PROP(LocalLobe, DoesNotDependOnTheFrame, ()) {
    const Surface flat;
    const Rough f{draw(0.05, 0.8), draw(0.05, 0.8)};
    const Field field{draw_psd(), draw_frame(-draw_leaving(flat.n))};
    const Vec3 out = draw_leaving(flat.n);
    const auto through = [&](const Field& light) {
        const auto pair = reflection_pair(light.frame, flat, out, micro_ggx(f.ax, f.ay));
        return scatter(light,
                       local_lobe(f, same, light.frame, pair, cosine_window(light.frame, flat.n)));
    };
    const Field one = through(field);
    const Field two = through(rotate_to(field, draw_frame_like(field.frame)));
    RC_ASSERT(is_psd(one.sigma, trace(field.sigma)));
    RC_ASSERT(distance(rotate_to(two, one.frame).sigma, one.sigma, largest(field.sigma)) < 1e-7);
}

RC_GTEST_PROP(LocalLobe, OfLambertIsTheCosineWindowAtNormalIncidenceAndNoLobe, ()) {
    const Surface flat;
    const Frame in = draw_frame(-flat.n);
    const Vec3 out = draw_leaving(flat.n);
    const auto pair = reflection_pair(in, flat, out, micro_ggx(1.0, 1.0));
    const auto lambert = [](const auto& wi, const auto&) { return wi.z; };
    const LocalLobe<double> local = local_lobe(lambert, same, in, pair, Sym2::diagonal(10, 10));
    RC_ASSERT(distance(local.window, cosine_window(in, flat.n)) < 1e-12);
    RC_ASSERT(largest(Matrix{}) + trace(local.pair.lobe) < 1e-12);
}

RC_GTEST_PROP(LocalLobe, OfAGaussianIsThatGaussianWhereverThePairLies, ()) {
    const Sym2 peak = draw_pd2();
    const double u = draw(-1, 1), v = draw(-1, 1);
    const J x(u, 1, 0), y(v, 0, 1);
    const J f =
        exp(-0.5 * kFourPiSq * 1e-2 * (peak.xx * x * x + 2 * peak.xy * x * y + peak.yy * y * y));
    RC_ASSERT(distance(local_lobe(f, 1e-2 * peak), 1e-2 * peak) < 1e-9);
    RC_ASSERT(local_lobe(J(0.0), peak) == peak);
    RC_ASSERT(local_lobe(J(-1.0, 2, 3), peak) == peak);
    RC_ASSERT(local_lobe(J(1.0, std::nan(""), 0), peak) == peak);
}

/// Largest s for which the Gaussian of covariance (4 pi^2 4 C)^-1 s^2 changes f at (r, 0) by at
/// most 2 %.
double usable_scale(const std::function<double(double, double)>& f, double r, const Sym2& c) {
    const double a = 1 / (4 * M_PI * std::sqrt(c.xx)), b = 1 / (4 * M_PI * std::sqrt(c.yy));
    const double value = f(r, 0);
    for (double s = 0.02; s < 100; s *= 1.05) {
        double sum = 0, weight = 0;
        for (int i = -16; i <= 16; ++i)
            for (int j = -16; j <= 16; ++j) {
                const double w = std::exp(-(i * i + j * j) / 32.0);
                sum += w * f(r + s * a * i / 4, s * b * j / 4);
                weight += w;
            }
        if (std::abs(sum / weight - value) > 0.02 * value) return s / 1.05;
    }
    return 100;
}

TEST(LocalLobe, ServesTheTailsOfGgxEvenly) {
    // A point light seen in a rough surface: from twice the roughness off the peak on, the light
    // changes on the scale of the distance to the peak. The peak's covariance does not know it: its
    // usable scale grows without end, the filter stays small. |Hess f| / f would vanish at the
    // steepest place, r = 1/sqrt(5).
    const auto f = [](double u, double v) { return 1 / std::pow(1 + u * u + v * v, 2); };
    const Sym2 peak = Sym2::diagonal(4 / kFourPiSq, 4 / kFourPiSq);
    double low = 100, high = 0, global_high = 0;
    for (const double r : {2.0, 4.0, 8.0, 16.0, 32.0}) {
        const J x(r, 1, 0), y(0, 0, 1), e = 1.0 + x * x + y * y;
        const double s = usable_scale(f, r, local_lobe(1.0 / (e * e), peak));
        low = std::min(low, s);
        high = std::max(high, s);
        global_high = std::max(global_high, usable_scale(f, r, peak));
    }
    EXPECT_GT(low, 0.9);
    EXPECT_LT(high, 1.2);
    EXPECT_GT(global_high, 5);
    const J x(1 / std::sqrt(5.0), 1, 0), y(0, 0, 1), e = 1.0 + x * x + y * y;
    const J steep = 1.0 / (e * e);
    EXPECT_NEAR(steep.uu, 0, 1e-12);
    EXPECT_GT(usable_scale(f, x.value, local_lobe(steep, peak)), 0.3);
}

// ---- pairs

RC_GTEST_PROP(Pairs, GlossyOperatorsAreTheirPairs, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Surface hit = draw_surface(field.frame.z);
    const Vec3 out = draw_leaving(hit.n);
    const Sym2 micro = micro_ggx(0.2, 0.4);
    const auto pair = reflection_pair(field.frame, hit, out, micro);
    RC_ASSERT(length(pair.outgoing.z - out) < 1e-12);
    RC_ASSERT(distance(scatter(field, pair).sigma,
                       convolve_angular(reflect_specular(field, hit, out), pair.lobe).sigma) <
              1e-13);
    // The map of a pair is that of a smooth facet.
    const double n1 = draw(1, 2), n2 = draw(1, 2);
    const auto bent = refraction_pair(field.frame, hit, -out, n1, n2, micro);
    RC_ASSERT(is_psd(bent.lobe, trace(bent.lobe)));
    RC_ASSERT(length(bent.outgoing.z + out) < 1e-12);
}

}  // namespace
}  // namespace support
