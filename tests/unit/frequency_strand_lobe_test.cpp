// The pair of directions that a strand joins, against the logarithm of what it scatters.
#include "frequency/strand_lobe.h"

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/warp.h"

namespace covtrace {
namespace {

namespace cov = covariance;

using Vec = cov::Vec3<double>;

/// Logarithm of a strand's lobe about x as a Gaussian in both angles.
double log_lobe(const LobeShare& lobe, Vec wo, Vec wi, double turn) {
    const auto theta = [](const Vec& w) { return std::asin(w.x / cov::length(w)); };
    const double t = theta(wo) + theta(wi);
    const double p =
        std::remainder(std::atan2(wi.z, wi.y) - std::atan2(wo.z, wo.y) - turn, 2 * cov::pi<double>);
    return -0.5 * (t * t / (lobe.alpha_x * lobe.alpha_x) + p * p / (lobe.alpha_y * lobe.alpha_y));
}

TEST(StrandLobe, KeepsTheLobeWhereBothSlopesMoveAndFallsWithItsWidthWhereOneDoes) {
    Rng rng(8);
    for (int i = 0; i < 500; ++i) {
        LobeShare lobe;
        lobe.kind = LobeKind::hair_reflection;
        lobe.alpha_x = 0.1f + rng.next_float();
        lobe.alpha_y = 0.1f + rng.next_float();
        const double theta = 2.6 * (rng.next_float() - 0.5), phi_o = 6 * rng.next_float(),
                     turn = 6 * rng.next_float();
        // At the lobe's peak
        const auto direction = [](double t, double p) -> Vec {
            return {std::sin(t), std::cos(t) * std::cos(p), std::cos(t) * std::sin(p)};
        };
        const Vec wo = direction(theta, phi_o), wi = direction(-theta, phi_o + turn);
        cov::Frame<double> in = cov::frame_along<double>(-wi);
        const auto pair = strand_pair(lobe, {1, 0, 0}, in, wo);
        const auto value = [&](double u, double v, bool with_arriving) {
            const auto& m = pair.map;
            const double a = with_arriving ? m.m00 * u + m.m01 * v : 0,
                         b = with_arriving ? m.m10 * u + m.m11 * v : 0;
            return log_lobe(lobe, wo + u * pair.outgoing.x + v * pair.outgoing.y,
                            -(in.z + a * in.x + b * in.y), turn);
        };
        const double h = 1e-4, size = -1 / (cov::four_pi_sq<double> * h * h);
        const double scale = 1 / (cov::four_pi_sq<double> * lobe.alpha_x * lobe.alpha_x) +
                             1 / (cov::four_pi_sq<double> * lobe.alpha_y * lobe.alpha_y);
        for (const auto& [u, v] : {std::pair{h, 0.0}, {0.0, h}, {h, h}})
            EXPECT_NEAR(size * (value(u, v, true) + value(-u, -v, true)), 0, 1e-3 * scale);
        EXPECT_NEAR(size * (value(h, 0, false) + value(-h, 0, false)), pair.lobe.xx, 1e-3 * scale);
        EXPECT_NEAR(size * (value(0, h, false) + value(0, -h, false)), pair.lobe.yy, 1e-3 * scale);
        EXPECT_NEAR(size * (value(h, h, false) + value(-h, -h, false)),
                    pair.lobe.xx + 2 * pair.lobe.xy + pair.lobe.yy, 1e-3 * scale);
    }
}

TEST(StrandLobe, IsEvenAboutTheStrandWhereAllAnglesAreAlike) {
    LobeShare lobe;
    lobe.kind = LobeKind::hair_transmission;
    lobe.alpha_x = 0.2f;
    lobe.alpha_y = std::numeric_limits<float>::infinity();
    const auto pair = strand_pair(lobe, {1, 0, 0}, {}, {0, 0.6, 0.8});
    EXPECT_EQ(pair.lobe.yy, 0);
    EXPECT_GT(pair.lobe.xx, 0);
    // Along the strand nothing is infinite.
    const auto along = strand_pair(lobe, {1, 0, 0}, {}, {1, 0, 0});
    EXPECT_TRUE(std::isfinite(along.map.m00) && std::isfinite(along.map.m11));
}

}  // namespace
}  // namespace covtrace
