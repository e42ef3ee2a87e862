/// Coated metals: the walk that `sample` takes against the one that `eval` takes, over bins of
/// directions, and against closed forms where there are any.
///
/// The walks estimate the same integrals by different means: `sample` follows the light until it
/// leaves, `eval` connects every bounce with a given direction. All bins together alarm falsely
/// with probability 0.01 (Šidák); the seeds are fixed.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "bsdf/bsdf.h"
#include "bsdf/fresnel.h"
#include "bsdf/multiple_scattering.h"
#include "chi_square.h"
#include "core/rng.h"
#include "core/warp.h"

namespace covtrace {
namespace {

struct Case {
    std::string name;
    CoatedConductorBsdf bsdf;
    float cos_o;
};
std::ostream& operator<<(std::ostream& out, const Case& c) {
    return out << c.name;
}

std::vector<Case> all_cases() {
    static const CoatTable white(kWhiteIndex, 0);
    struct Roughness {
        const char* name;
        float coat, metal;
        bool multiple_scattering = false;
        float gap_albedo = 0, g = 0;
    };
    std::vector<Case> cases;
    for (const Roughness& r : {Roughness{"smooth_on_rough", 0, 0.3f},
                               {"rough_on_smooth", 0.3f, 0},
                               {"both_rough", 0.3f, 0.5f},
                               {"fine_on_rough", 0.1f, 0.6f},
                               {"smooth_on_bouncing", 0, 0.8f, true},
                               {"fine_on_bouncing", 0.1f, 0.8f, true},
                               {"haze_on_smooth", 0, 0, false, 0.8f, 0.5f},
                               {"haze_on_rough", 0, 0.3f, false, 0.8f, -0.3f},
                               {"rough_haze_on_smooth", 0.3f, 0, false, 0.8f, 0},
                               {"rough_haze_on_rough", 0.3f, 0.5f, false, 0.8f, 0.7f}})
        for (const float cos_o : {0.95f, 0.5f, 0.15f}) {
            CoatedConductorBsdf b;
            b.coat = {1.5f, r.coat, r.coat};
            b.metal = {Rgb(0.13f, 0.6f, 0.73f), Rgb(2.6f, 1.63f, 1.43f), r.metal, r.metal};
            if (r.multiple_scattering) b.metal = with_multiple_scattering(b.metal, white);
            b.thickness = r.gap_albedo > 0 ? 0.4f : 0.05f;
            b.gap = {Rgb(r.gap_albedo), r.g, 10};
            cases.push_back(
                {std::string(r.name) + "_at_" + std::to_string(int(100 * cos_o)), b, cos_o});
        }
    return cases;
}

class CoatedConductor : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Models, CoatedConductor, testing::ValuesIn(all_cases()),
                         [](const auto& c) { return c.param.name; });

constexpr int kTheta = 5, kPhi = 6;

size_t bin(Vec3 w) {
    const int t = std::min(kTheta - 1, int(w.z * kTheta));
    const double turn = std::atan2(w.y, w.x) / (2 * M_PI) + 0.5;
    return size_t(t * kPhi + std::min(kPhi - 1, int(turn * kPhi)));
}

/// Sums of a random variable per bin.
struct Moments {
    std::array<double, kTheta * kPhi> sum{}, square{};
    void add(size_t i, double v) {
        sum[i] += v;
        square[i] += v * v;
    }
};

TEST_P(CoatedConductor, SampleAndEvalEstimateTheSame) {
    const Bsdf bsdf = GetParam().bsdf;
    const float cos_o = GetParam().cos_o;
    const Vec3 wo{std::sqrt(1 - cos_o * cos_o), 0, cos_o};
    constexpr int kWalks = 150000;
    Moments sampled, evaluated;
    Rng rng(21);
    for (int i = 0; i < kWalks; ++i) {
        const float u_lobe = rng.next_float();
        const auto s = sample(bsdf, wo, u_lobe, rng.next_2d());
        // The smooth coat's own reflection is no part of eval.
        if (s && !is_specular(s->lobe)) sampled.add(bin(s->wi), luminance(s->weight));
    }
    for (int i = 0; i < kWalks; ++i) {
        const Vec3 wi = square_to_cosine_hemisphere(rng.next_2d());
        if (wi.z > 0)
            evaluated.add(bin(wi), luminance(eval(bsdf, wo, wi)) / cosine_hemisphere_pdf(wi.z));
    }
    int tests = 0;
    double smallest = 1;
    for (size_t i = 0; i < sampled.sum.size(); ++i) {
        const auto mean = [](double v) { return v / kWalks; };
        const double a = mean(sampled.sum[i]), b = mean(evaluated.sum[i]);
        const double variance =
            (mean(sampled.square[i]) - a * a + mean(evaluated.square[i]) - b * b) / kWalks;
        if (!(variance > 0)) continue;
        ++tests;
        const double z = (a - b) / std::sqrt(variance);
        smallest = std::min(smallest, std::erfc(std::abs(z) / std::sqrt(2.0)));
    }
    const double level = 1 - std::pow(1 - 0.01, 1.0 / (tests * double(all_cases().size())));
    EXPECT_GT(smallest, level) << tests << " bins";
}

TEST(CoatedConductorLimits, SmoothBordersSumTheSeries) {
    // The light comes back, if late, from a metal that reflects everything under a clear coat.
    CoatedConductorBsdf b;
    b.coat = {1.5f, 0, 0};
    b.metal = {Rgb(1e-4f), Rgb(1e3f), 0, 0};
    b.bounces = 200;
    for (const float cos_o : {1.0f, 0.6f, 0.1f}) {
        const Vec3 wo{std::sqrt(1 - cos_o * cos_o), 0, cos_o};
        const auto s = sample(Bsdf(b), wo, 0.3f, {0.1f, 0.7f});
        ASSERT_TRUE(s);
        EXPECT_NEAR(s->weight.g, 1, 2e-3f);
        EXPECT_EQ(s->wi, (Vec3{-wo.x, -wo.y, wo.z}));
    }
}

TEST(CoatedConductorLimits, AGapThatKeepsAllLightLosesNone) {
    // Over a metal that reflects all light, under a smooth coat. Rough ones lose light by single
    // scattering whenever light is reflected inside.
    for (const float g : {-0.5f, 0.7f})
        for (const float cos_o : {1.0f, 0.4f}) {
            CoatedConductorBsdf b;
            b.coat = {1.5f, 0, 0};
            b.metal = {Rgb(1e-4f), Rgb(1e3f), 0, 0};
            b.thickness = 0.8f;
            b.gap = {Rgb(1), g, 500};
            const Vec3 wo{std::sqrt(1 - cos_o * cos_o), 0, cos_o};
            constexpr int kWalks = 40000;
            Rng rng(8);
            double mirrored = 0, scattered = 0, evaluated = 0, square = 0;
            for (int i = 0; i < kWalks; ++i) {
                const float u_lobe = rng.next_float();
                const auto s = sample(Bsdf(b), wo, u_lobe, rng.next_2d());
                if (s) (is_specular(s->lobe) ? mirrored : scattered) += s->weight.g / kWalks;
            }
            EXPECT_NEAR(mirrored + scattered, 1, 0.01) << g << " " << cos_o;
            for (int i = 0; i < kWalks; ++i) {
                const Vec3 wi = square_to_cosine_hemisphere(rng.next_2d());
                const double f = eval(Bsdf(b), wo, wi).g / cosine_hemisphere_pdf(wi.z);
                evaluated += f / kWalks;
                square += f * f / kWalks;
            }
            const double error = std::sqrt((square - evaluated * evaluated) / kWalks);
            EXPECT_LT(error, 0.02);
            EXPECT_NEAR(evaluated, 1 - mirrored, 4 * error) << g << " " << cos_o;
        }
}

TEST(CoatedConductorLimits, ACoatOfIndexOneIsNoCoat) {
    CoatedConductorBsdf b;
    b.coat = {1, 0, 0};
    b.metal = {Rgb(0.2f, 0.9f, 1.1f), Rgb(3.9f, 2.4f, 2.1f), 0.3f, 0.3f};
    const Bsdf coated = b, bare = b.metal;
    Rng rng(5);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 wo = square_to_cosine_hemisphere(rng.next_2d());
        const Vec3 wi = square_to_cosine_hemisphere(rng.next_2d());
        const Rgb a = eval(coated, wo, wi), c = eval(bare, wo, wi);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], c[k], 1e-4f * c[k] + 1e-6f);
    }
}

TEST(CoatedConductorLimits, OneBounceUnderASmoothCoatHasAClosedForm) {
    CoatedConductorBsdf b;
    b.coat = {1.5f, 0, 0};
    b.metal = {Rgb(0.13f, 0.6f, 0.73f), Rgb(2.6f, 1.63f, 1.43f), 0.4f, 0.4f};
    b.thickness = 0.1f;
    b.bounces = 1;
    Rng rng(6);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 wo = square_to_cosine_hemisphere(rng.next_2d());
        const Vec3 wi = square_to_cosine_hemisphere(rng.next_2d());
        if (std::min(wo.z, wi.z) < 0.01f) continue;
        const auto o = fresnel_dielectric(wo.z, 1.5f), in = fresnel_dielectric(wi.z, 1.5f);
        const Vec3 to{wo.x / 1.5f, wo.y / 1.5f, o.cos_t}, ti{wi.x / 1.5f, wi.y / 1.5f, in.cos_t};
        const Rgb expected = eval(Bsdf(b.metal), to, ti) / in.cos_t * wi.z *
                             ((1 - o.reflectance) * (1 - in.reflectance) / sqr(1.5f) *
                              std::exp(-0.1f / o.cos_t - 0.1f / in.cos_t));
        const Rgb value = eval(Bsdf(b), wo, wi);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(value[k], expected[k], 1e-3f * expected[k] + 1e-6f);
    }
}

TEST(ThinDielectric, SumsTheSeriesOfBothFaces) {
    const float r = fresnel_dielectric(0.7f, 1.5f).reflectance;
    const Vec3 wo{std::sqrt(1 - 0.49f), 0, -0.7f};
    const float both = 2 * r / (1 + r);
    const auto mirrored = sample(Bsdf(ThinDielectricBsdf{1.5f}), wo, 0.99f * both, {});
    const auto passed = sample(Bsdf(ThinDielectricBsdf{1.5f}), wo, 1.01f * both, {});
    ASSERT_TRUE(mirrored && passed);
    EXPECT_NEAR(mirrored->pdf, both, 1e-5f);
    EXPECT_EQ(mirrored->wi, (Vec3{-wo.x, -wo.y, wo.z}));
    EXPECT_NEAR(passed->pdf, 1 - both, 1e-5f);
    EXPECT_EQ(passed->wi, -wo);
}

}  // namespace
}  // namespace covtrace
