/// Light that single scattering loses is given back: furnaces of rough metals and rough glass, and
/// how much of it a metal absorbs.
#include <gtest/gtest.h>

#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/multiple_scattering.h"
#include "core/rng.h"

namespace covtrace {
namespace {

constexpr float kAlphas[] = {0.001f, 0.01f, 0.04f, 0.1f, 0.25f, 0.5f, 0.81f, 1};
constexpr float kCosines[] = {0.02f, 0.1f, 0.3f, 0.5f, 0.8f, 1};
constexpr int kSide = 128;

Vec3 towards(float cos_theta, float phi = 0) {
    const float r = std::sqrt(1 - cos_theta * cos_theta);
    return {r * std::cos(phi), r * std::sin(phi), cos_theta};
}

const CoatTable& white() {
    static const CoatTable table(kWhiteIndex, 0);
    return table;
}

/// Grey metal of the index n and absorption k.
ConductorBsdf metal(float n, float k, float alpha_x, float alpha_y) {
    return {Rgb(n), Rgb(k), alpha_x, alpha_y};
}
/// A metal that reflects everything, to single precision.
ConductorBsdf white_metal(float alpha_x, float alpha_y) {
    return metal(1e-3f, 1e3f, alpha_x, alpha_y);
}

/// Energy that leaves for a unit of light along wo, by a jittered grid of kSide^2 samples.
double furnace(const Bsdf& bsdf, Vec3 wo) {
    Rng rng(31);
    double sum = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const Vec2 u{(static_cast<float>(i % kSide) + rng.next_float()) / kSide,
                     (static_cast<float>(i / kSide) + rng.next_float()) / kSide};
        const auto s = sample(bsdf, wo, rng.next_float(), u);
        if (s) sum += s->weight.g * sqr(s->eta);
    }
    return sum / (kSide * kSide);
}

/// Asserts that nothing is lost within what the noise of the samples and the table leave.
void expect_no_loss(const Bsdf& bsdf, double tolerance) {
    for (const float cos_o : kCosines) {
        EXPECT_NEAR(furnace(bsdf, towards(cos_o)), 1, tolerance) << cos_o;
        EXPECT_NEAR(furnace(bsdf, towards(-cos_o, 1)), 1, tolerance) << -cos_o;
    }
}

TEST(MultipleScattering, WhiteMetalGivesBackAllLight) {
    for (const float alpha : kAlphas) {
        SCOPED_TRACE(alpha);
        // The table's rows are coarse for nearly smooth borders at grazing angles.
        expect_no_loss(with_multiple_scattering(white_metal(alpha, alpha), white()),
                       alpha == 0.01f ? 1e-2 : 5e-3);
    }
}

TEST(MultipleScattering, ClearGlassLosesNothingFromEitherSide) {
    for (const float eta : {1.33f, 2.4f, 1 / 1.5f}) {
        const CoatTable outside(eta, 0), inside(1 / eta, 0);
        for (const float alpha : kAlphas) {
            SCOPED_TRACE(testing::Message() << eta << " " << alpha);
            expect_no_loss(
                with_multiple_scattering(DielectricBsdf{eta, alpha, alpha}, outside, inside), 1e-2);
        }
    }
}

TEST(MultipleScattering, EvalGivesBackWhatSamplesDo) {
    const Bsdf bsdf = with_multiple_scattering(white_metal(0.5f, 0.5f), white());
    for (const float cos_o : {0.3f, 0.9f}) {
        constexpr int n = 400;
        double sum = 0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                sum += eval(bsdf, towards(cos_o),
                            towards((static_cast<float>(i) + 0.5f) / n,
                                    2 * kPi * (static_cast<float>(j) + 0.5f) / n))
                           .g;
        EXPECT_NEAR(sum * 2 * M_PI / n / n, 1, 3e-3) << cos_o;
    }
}

TEST(MultipleScattering, BrushedMetalsAreNearIt) {
    const Bsdf bsdf = with_multiple_scattering(white_metal(0.1f, 0.5f), white());
    double sum = 0;
    int count = 0;
    for (const float cos_o : {0.15f, 0.4f, 0.75f, 1.0f})
        for (const float phi : {0.0f, 0.8f, 1.57f}) {
            const double kept = furnace(bsdf, towards(cos_o, phi));
            EXPECT_GT(kept, 0.87) << cos_o << " " << phi;
            EXPECT_LT(kept, 1.05) << cos_o << " " << phi;
            sum += kept;
            ++count;
        }
    EXPECT_NEAR(sum / count, 1, 0.02);
}

/// Light that leaves a rough grey metal whose roughness returns all of the light that a reflection
/// does not let out at random, until it leaves: each time the mean share.
double reflected_until_it_leaves(double once, double kept, double mean_kept, double reflectance) {
    double sum = once, left = once / kept * (1 - kept);
    for (int i = 0; i < 200; ++i) {
        left *= reflectance;
        sum += left * mean_kept;
        left *= 1 - mean_kept;
    }
    return sum;
}

TEST(MultipleScattering, MetalAbsorbsAtEachReflection) {
    constexpr float kAlpha = 0.7f;
    double mean_kept = 0;
    constexpr int n = 16;
    for (int i = 0; i < n; ++i)
        mean_kept += furnace(white_metal(kAlpha, kAlpha),
                             towards(std::sqrt((static_cast<float>(i) + 0.5f) / n))) /
                     n;
    for (const float k : {0.7f, 2.0f, 6.0f}) {
        double reflectance = 0;
        constexpr int m = 2000;
        for (int i = 0; i < m; ++i)
            reflectance +=
                double(fresnel_conductor(std::sqrt((static_cast<float>(i) + 0.5f) / m), 1, k)) / m;
        for (const float cos_o : {0.3f, 1.0f}) {
            const ConductorBsdf grey = metal(1, k, kAlpha, kAlpha);
            const Vec3 wo = towards(cos_o);
            const double expected = reflected_until_it_leaves(
                furnace(grey, wo), furnace(white_metal(kAlpha, kAlpha), wo), mean_kept,
                reflectance);
            EXPECT_NEAR(furnace(with_multiple_scattering(grey, white()), wo), expected,
                        4e-3 * expected)
                << k << " " << cos_o;
        }
    }
}

TEST(MultipleScattering, MirrorsAndWindowsStayAsTheyAre) {
    const CoatTable outside(1.5f, 0), inside(1 / 1.5f, 0);
    const Bsdf mirror = with_multiple_scattering(metal(1, 2, 0, 0), white());
    const Bsdf glass = with_multiple_scattering(DielectricBsdf{1.5f}, outside, inside);
    EXPECT_TRUE(is_specular(mirror) && is_specular(glass));
    for (const float cos_o : kCosines) {
        const Vec3 wo = towards(cos_o);
        EXPECT_EQ(sample(mirror, wo, 0, {})->weight,
                  sample(Bsdf(metal(1, 2, 0, 0)), wo, 0, {})->weight);
        EXPECT_EQ(sample(glass, wo, 0.999f, {})->weight,
                  sample(Bsdf(DielectricBsdf{1.5f}), wo, 0.999f, {})->weight);
    }
}

// As a function of wi the lobe keeps its shape, and its density: the spectrum is that of the lobe
// that is reflected once.
TEST(MultipleScattering, GainIsTheSameForAllDirectionsOfLight) {
    const CoatTable outside(1.5f, 0), inside(1 / 1.5f, 0);
    const DielectricBsdf glass{1.5f, 0.4f, 0.4f};
    const ConductorBsdf grey = metal(1, 2, 0.4f, 0.4f);
    const std::pair<Bsdf, Bsdf> pairs[] = {
        {grey, with_multiple_scattering(grey, white())},
        {glass, with_multiple_scattering(glass, outside, inside)}};
    for (const auto& [once, all] : pairs)
        for (const float cos_o : {-0.8f, -0.2f, 0.3f, 0.9f}) {
            const Vec3 wo = towards(cos_o);
            Rng rng(5);
            float gain = 0;
            for (int i = 0; i < 100; ++i) {
                const auto s = sample(all, wo, rng.next_float(), rng.next_2d());
                if (!s) continue;
                EXPECT_EQ(pdf(all, wo, s->wi), pdf(once, wo, s->wi));
                const float ratio = eval(all, wo, s->wi).g / eval(once, wo, s->wi).g;
                if (gain == 0) gain = ratio;
                EXPECT_NEAR(ratio, gain, 1e-4f);
                EXPECT_GT(ratio, 1.005f);
            }
        }
}

}  // namespace
}  // namespace covtrace
