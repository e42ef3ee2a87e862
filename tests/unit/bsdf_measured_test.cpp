// Measured BRDFs against the analytic ones that their tables were made of.
#include "bsdf_measured_tensor.h"

#include <gtest/gtest.h>

#include "bsdf/bsdf.h"
#include "bsdf/measured_brdf.h"
#include "core/rng.h"
#include "core/warp.h"

namespace covtrace {
namespace {

TEST(BilinearDensity, SampleAndInvertAreInverse) {
    // Two tables mixed, one of them with an empty corner
    const std::vector<float> tables{0, 0, 1, 0, 0, 3, 2, 5, 1, /**/ 1, 2, 3, 1, 1, 1, 4, 0, 2};
    const BilinearDensity density(3, 3, tables);
    const TableWeights mixed{{0, 1}, {0.3f, 0.7f}, 2};
    Rng rng(5);
    double mean_inverse = 0;
    constexpr int kCount = 20000;
    for (int i = 0; i < kCount; ++i) {
        const Vec2 u = rng.next_2d();
        const auto s = density.sample(u, mixed);
        ASSERT_GT(s.pdf, 0);
        EXPECT_NEAR(density.pdf(s.place, mixed), s.pdf, 1e-3f * s.pdf + 1e-4f);
        const auto back = density.invert(s.place, mixed);
        EXPECT_NEAR(back.place.x, u.x, 2e-3f);
        EXPECT_NEAR(back.place.y, u.y, 2e-3f);
        EXPECT_NEAR(back.pdf, s.pdf, 1e-3f * s.pdf + 1e-4f);
        mean_inverse += 1 / double(s.pdf) / kCount;
    }
    // The mean of 1 / pdf is the area where the density is not 0: all of it
    EXPECT_NEAR(mean_inverse, 1, 0.03);
}

TEST(BilinearDensity, IntegratesToOneAndIsEvenForZeros) {
    const BilinearDensity density(3, 2,
                                  std::vector<float>{1, 4, 2, 0, 1, 1, /**/ 0, 0, 0, 0, 0, 0});
    for (const size_t table : {0u, 1u}) {
        double sum = 0;
        for (int i = 0; i < 200; ++i)
            for (int j = 0; j < 200; ++j)
                sum += density.pdf({(float(i) + 0.5f) / 200, (float(j) + 0.5f) / 200},
                                   {{table}, {1}, 1});
        EXPECT_NEAR(sum / 40000, 1, 1e-3) << table;
    }
    EXPECT_NEAR(density.pdf({0.1f, 0.9f}, {{1}, {1}, 1}), 1, 1e-5f);
}

/// Mean relative difference of the value from the analytic mirror's, over the light that both send
/// to one side.
double difference(const Bsdf& measured, const Ggx& ggx, Vec3 wo) {
    Rng rng(8);
    double apart = 0, sum = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3 m = ggx.sample_visible_normal(wo, rng.next_2d());
        const Vec3 wi = 2 * dot(wo, m) * m - wo;
        if (!(wi.z > 0.02f)) continue;
        const float truth = 0.25f * ggx.d(m) * ggx.g2_over_cos_o(wo, wi);
        const Rgb value = eval(measured, wo, wi);
        EXPECT_NEAR(value.g, 0.5f * value.r, 1e-4f * value.r);
        // By the density of the samples both sums are integrals over wi
        const float density = ggx.reflection_pdf(wo, m);
        apart += std::abs(value.r - truth) / density;
        sum += truth / density;
    }
    return apart / sum;
}

TEST(MeasuredBrdf, EqualsTheMetalThatItsTablesWereMadeOf) {
    const Ggx ggx{0.35f, 0.35f};
    const MeasuredBrdf brdf(ggx_tensor(0.35f, 0.35f, 24, 1, 128));
    for (const float degrees : {3.0f, 30.0f, 55.0f, 72.0f})
        for (const float phi : {0.0f, 2.0f})
            EXPECT_LT(difference(MeasuredBsdf{&brdf}, ggx, at_angles(degrees * kPi / 180, phi)),
                      0.02)
                << degrees;
    EXPECT_NEAR(brdf.alpha(), 0.35f, 0.02f);
    EXPECT_FALSE(brdf.is_wide());
}

TEST(MeasuredBrdf, BrushedMetalTurnsWithTheAzimuth) {
    const Ggx ggx{0.25f, 0.6f};
    const MeasuredBrdf brdf(ggx_tensor(0.25f, 0.6f, 20, 25, 64));
    for (const float phi : {-2.5f, -0.4f, 0.8f, 3.0f})
        EXPECT_LT(difference(MeasuredBsdf{&brdf}, ggx, at_angles(0.7f, phi)), 0.04) << phi;
    const Ggx turned{0.6f, 0.25f};
    EXPECT_GT(difference(MeasuredBsdf{&brdf}, turned, at_angles(0.7f, 0.8f)), 0.2);
}

TEST(MeasuredBrdf, SamplesByItsDensity) {
    const MeasuredBrdf brdf(ggx_tensor(0.35f, 0.35f, 16, 1, 64));
    const MeasuredBsdf b{&brdf};
    Rng rng(4);
    for (const Vec3 wo : {at_angles(0.2f, 1), at_angles(1.2f, -2), -at_angles(0.6f, 1)}) {
        int sampled = 0, count = 4000;
        for (int i = 0; i < count; ++i) {
            const auto s = sample(Bsdf{b}, wo, 0.5f, rng.next_2d());
            if (!s) continue;
            ++sampled;
            ASSERT_GT(s->wi.z * wo.z, 0);
            if (std::abs(s->wi.z) < 0.02f) continue;
            EXPECT_NEAR(pdf(Bsdf{b}, wo, s->wi) / s->pdf, 1, 0.02f);
            const Rgb value = eval(Bsdf{b}, wo, s->wi);
            EXPECT_NEAR(value.r, s->weight.r * s->pdf, 0.02f * value.r + 1e-4f);
        }
        // The density's integral over the hemisphere is the share of samples that succeed
        double integral = 0;
        constexpr int kSide = 600;
        for (int i = 0; i < kSide; ++i)
            for (int j = 0; j < kSide; ++j) {
                const float z = (float(i) + 0.5f) / kSide,
                            phi = 2 * kPi * (float(j) + 0.5f) / kSide;
                const float r = std::sqrt(1 - z * z);
                const Vec3 wi{r * std::cos(phi), r * std::sin(phi), wo.z > 0 ? z : -z};
                integral += double(pdf(Bsdf{b}, wo, wi)) * 2 * kPi / (kSide * kSide);
            }
        EXPECT_NEAR(integral, double(sampled) / count, 0.03);
    }
}

TEST(MeasuredBrdf, ReflectsAsTheDiffuseSurfaceDoes) {
    const MeasuredBrdf brdf(diffuse_tensor({0.6f, 0.4f, 0.2f}));
    const Bsdf b = MeasuredBsdf{&brdf};
    EXPECT_TRUE(brdf.is_wide());
    EXPECT_TRUE(has_diffuse_lobe(b));
    EXPECT_FALSE(has_sharp_lobe(b));
    Rng rng(6);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 wo = at_angles(1.4f * rng.next_float(), 6 * rng.next_float());
        const Vec3 wi = square_to_cosine_hemisphere(rng.next_2d());
        const Rgb value = eval(b, wo, wi);
        EXPECT_NEAR(value.r, 0.6f * wi.z * kInvPi, 0.02f * wi.z + 2e-3f);
        EXPECT_EQ(is_black(eval(b, wo, -wi)), true);
    }
    const Rgb a = albedo(b, at_angles(0.5f, 0));
    EXPECT_NEAR(a.r, 0.6f, 0.03f);
    EXPECT_NEAR(a.b, 0.2f, 0.01f);
    const LobeShares shares = lobe_shares(b, {0, 0, 1}, {0, 0.6f, 0.8f}, Rgb(0.3f));
    ASSERT_EQ(shares.count, 1);
    EXPECT_EQ(shares.lobes[0].kind, LobeKind::diffuse_reflection);
}

}  // namespace
}  // namespace covtrace
