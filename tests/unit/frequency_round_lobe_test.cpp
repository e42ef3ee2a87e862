// Lobes of one roughness in closed form are the general lobes with both roughnesses equal.
#include "frequency/round_lobe.h"

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/warp.h"
#include "frequency/fresnel_derivatives.h"
#include "frequency/ggx_derivatives.h"

namespace covtrace {
namespace {

namespace cov = covariance;

using Vec = cov::Vec3<double>;

Vec unit(Vec3 v) {
    return cov::normalized_or<double>(v, {0, 0, 1});
}

/// Lobes with borders of none, glass from both sides, and metal, by its index and by its colours.
LobeShare lobe_of(int i, Rng& rng) {
    LobeShare lobe;
    lobe.kind = LobeKind::glossy_reflection;
    lobe.alpha_x = lobe.alpha_y = 0.02f + rng.next_float();
    const float indices[] = {0, 1.5f, 0.7f, 0.3f, 0};
    lobe.border_eta = indices[i % 5];
    lobe.border_k = i % 5 == 3 ? 3.5f : 0.0f;
    if (i % 5 == 4) lobe.border_metal = SchlickMetal<float>{0.7f, 1, 3};
    return lobe;
}

RoundReflection general(const LobeShare& lobe, const cov::Frame<double>& in, const Vec& outgoing,
                        const Vec& n) {
    const cov::Frame<double> tangent = cov::frame_along<double>(n);
    const cov::Surface<double> surface{n, tangent.x, tangent.y, {}};
    const auto pair = cov::reflection_pair<double>(
        in, surface, outgoing, cov::micro_ggx<double>(lobe.alpha_x, lobe.alpha_y));
    const auto local = [&](const Vec& v) -> Vec {
        return {cov::dot(v, tangent.x), cov::dot(v, tangent.y), cov::dot(v, tangent.z)};
    };
    const cov::Frame<double>& out = pair.outgoing;
    const LocalAxes to_light{local(-in.x), local(-in.y), local(-in.z)};
    const auto arriving = log_masked_cosine(lobe, local(out.z), to_light);
    const auto leaving =
        log_reflection(lobe, {local(out.x), local(out.y), local(out.z)}, to_light.z);
    return {out,
            cov::limited_by(cov::positive_part(cov::curvature_of_log(arriving)),
                            cov::cosine_window<double>(in, n)),
            leaving ? cov::local_lobe_of_log(*leaving, pair.lobe) : pair.lobe};
}

void expect_same(const cov::Sym2<double>& a, const cov::Sym2<double>& b) {
    const double tolerance = 1e-8 * cov::trace(b);
    EXPECT_NEAR(a.xx, b.xx, tolerance);
    EXPECT_NEAR(a.xy, b.xy, tolerance);
    EXPECT_NEAR(a.yy, b.yy, tolerance);
}

TEST(RoundLobe, IsTheGeneralLobeWithEqualRoughnesses) {
    Rng rng(5);
    int below_peak = 0;
    for (int i = 0; i < 2000; ++i) {
        const LobeShare lobe = lobe_of(i, rng);
        const Vec n = unit(square_to_sphere(rng.next_2d()));
        const Vec outgoing = unit(square_to_sphere(rng.next_2d()));
        const auto in = cov::frame_along<double>(unit(square_to_sphere(rng.next_2d())));
        const auto a = round_reflection(lobe, in, outgoing, n), b = general(lobe, in, outgoing, n);
        EXPECT_NEAR(cov::length(a.outgoing.x - b.outgoing.x), 0, 1e-12);
        EXPECT_NEAR(cov::length(a.outgoing.y - b.outgoing.y), 0, 1e-12);
        EXPECT_NEAR(cov::length(a.outgoing.z - outgoing), 0, 1e-12);
        expect_same(a.window, b.window);
        expect_same(a.lobe, b.lobe);
        const double cos_h = std::abs(cov::dot(cov::half_vector<double>(in.z, outgoing, n), in.z));
        const double peak =
            1 / (cov::four_pi_sq<double> * cos_h * cos_h * lobe.alpha_x * lobe.alpha_x);
        below_peak += cov::trace(a.lobe) < 0.5 * peak;
    }
    EXPECT_GT(below_peak, 200);
}

TEST(RoundLobe, HoldsAtNormalIncidence) {
    LobeShare lobe;
    lobe.kind = LobeKind::glossy_reflection;
    lobe.alpha_x = lobe.alpha_y = 0.3f;
    lobe.border_eta = 1.5f;
    const auto in = cov::frame_along<double>({0, 0, -1});
    const auto a = round_reflection(lobe, in, {0, 0, 1}, {0, 0, 1}),
               b = general(lobe, in, {0, 0, 1}, {0, 0, 1});
    expect_same(a.window, b.window);
    expect_same(a.lobe, b.lobe);
}

TEST(FresnelDerivatives, AreThoseOfTheBordersFunction) {
    Rng rng(6);
    for (int i = 0; i < 500; ++i) {
        const LobeShare lobe = lobe_of(i, rng);
        const double c = 0.02 + 0.98 * double(rng.next_float());
        const double e2 = double(lobe.border_eta) * lobe.border_eta;
        if (lobe.border_eta > 0 && std::abs(e2 - 1 + c * c) < 1e-3) continue;  // infinite there
        const auto a = reflectance_at(lobe, c);
        const auto b = border_reflectance(lobe, cov::Taylor<double>{c, 1, 0});
        EXPECT_NEAR(a.value, b.value, 1e-6);  // the value is of a square of the index in float
        EXPECT_NEAR(a.first, b.first, 1e-5 * (1 + std::abs(b.first)));
        EXPECT_NEAR(a.second, b.second, 1e-4 * (1 + std::abs(b.second)));
    }
}

}  // namespace
}  // namespace covtrace
