/// Sheens and clear coats: their energy, and what they leave to the surface below. The values are
/// held against Khronos's formulas in tests/cli/test_gltf_layers.py.
#include <gtest/gtest.h>

#include <algorithm>

#include "bsdf/coat_table.h"
#include "bsdf/models.h"
#include "bsdf/schlick_metal.h"
#include "bsdf/sheen.h"
#include "core/frame.h"
#include "core/warp.h"

namespace covtrace {
namespace {

const SheenTable& table() {
    static const SheenTable t;
    return t;
}
Vec3 at_cos(float c) {
    return {std::sqrt(1 - c * c), 0, c};
}

/// Directional albedo by midpoints over the hemisphere, dense at grazing angles; without specular
/// lobes.
Rgb integrated(const Bsdf& bsdf, Vec3 wo) {
    constexpr int kSide = 500;
    Rgb sum;
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
            const float root = (float(i) + 0.5f) / kSide, z = root * root;
            const float r = std::sqrt(1 - z * z), phi = 2 * kPi * (float(j) + 0.5f) / kSide;
            sum += eval(bsdf, wo, {r * std::cos(phi), r * std::sin(phi), z}) * (4 * kPi * root);
        }
    return sum / (kSide * kSide);
}

TEST(SheenTable, IsTheIntegral) {
    for (const float alpha : {0.02f, 0.09f, 0.3f, 1.0f})
        for (const float c : {0.03f, 0.2f, 0.6f, 1.0f}) {
            const Vec3 wo = at_cos(c);
            constexpr int kSide = 800;
            double sum = 0;
            for (int i = 0; i < kSide; ++i)
                for (int j = 0; j < kSide; ++j) {
                    const float z = (float(i) + 0.5f) / kSide, r = std::sqrt(1 - z * z);
                    const float phi = kPi * (float(j) + 0.5f) / kSide;
                    sum += sheen_value(alpha, wo, Vec3{r * std::cos(phi), r * std::sin(phi), z});
                }
            const double albedo = sum * 2 * M_PI / (kSide * kSide);
            EXPECT_NEAR(table().albedo(alpha, c), albedo, 0.003 + 0.01 * albedo)
                << alpha << " " << c;
        }
}

TEST(LayeredBsdf, WhiteSheenOverWhiteKeepsMostLightAndMakesNone) {
    for (const float alpha : {0.005f, 0.02f, 0.1f, 0.5f, 1.0f})
        for (const float c : {0.005f, 0.03f, 0.1f, 0.4f, 0.8f, 1.0f}) {
            const Bsdf white = LayeredBsdf{DiffuseBsdf{Rgb(1)}, {Rgb(1), alpha, &table()}, {}};
            const float kept = integrated(white, at_cos(c)).g;
            EXPECT_LE(kept, 1.01f) << alpha << " " << c;
            // The larger albedo of both directions is taken from the base, so that some is lost.
            EXPECT_GE(kept, 0.6f) << alpha << " " << c;
        }
}

TEST(LayeredBsdf, ClearcoatTakesWhatItReflects) {
    for (const float weight : {0.3f, 1.0f})
        for (const float c : {0.1f, 0.5f, 1.0f}) {
            const Vec3 wo = at_cos(c);
            const float reflected = weight * (0.04f + 0.96f * std::pow(1 - c, 5.0f));
            const Bsdf smooth = LayeredBsdf{DiffuseBsdf{Rgb(1)}, {}, {weight, 0}};
            EXPECT_NEAR(integrated(smooth, wo).g, 1 - reflected, 0.003f) << weight << " " << c;
            const auto s = sample(smooth, wo, 0, {0.5f, 0.5f});
            ASSERT_TRUE(s);
            EXPECT_EQ(s->lobe, LobeKind::specular_reflection);
            EXPECT_NEAR(s->weight.g * s->pdf, reflected, 1e-5f);
            EXPECT_NEAR(distance(s->wi, {-wo.x, -wo.y, wo.z}), 0, 1e-5f);
            // A rough coat loses some light, as GGX does.
            const Bsdf rough = LayeredBsdf{DiffuseBsdf{Rgb(1)}, {}, {weight, 0.1f}};
            const float all = integrated(rough, wo).g;
            EXPECT_LE(all, 1.003f);
            EXPECT_GE(all, 1 - 0.2f * reflected);
        }
}

TEST(LayeredBsdf, CoatsWithABorderLeaveWhatTheyReflectAndTint) {
    static const CoatTable border(1.6f, 0);
    const Rgb tint(0.8f, 0.4f, 1);
    constexpr float kWeight = 0.7f;
    for (const float alpha : {0.0f, 0.1f, 0.5f, 1.0f})
        for (const float c : {0.1f, 0.5f, 1.0f}) {
            const Vec3 wo = at_cos(c);
            // White below keeps all light that is not tinted.
            const Bsdf clear = LayeredBsdf{DiffuseBsdf{Rgb(1)}, {}, {1, alpha, {0, 0, 1}, &border}};
            const float mirrored =
                alpha == 0 ? fresnel_dielectric(c, border.eta()).reflectance : 0.0f;
            EXPECT_NEAR(integrated(clear, wo).g + mirrored, 1, 0.006f) << alpha << " " << c;
            // Black below shows the coat alone, and both together the tint of what gets through.
            const ClearcoatLobe tinted{kWeight, alpha, {0, 0, 1}, &border, tint};
            const Rgb coat = integrated(LayeredBsdf{DiffuseBsdf{}, {}, tinted}, wo);
            const Rgb all = integrated(LayeredBsdf{DiffuseBsdf{Rgb(0.5f)}, {}, tinted}, wo);
            const float passed = 1 - kWeight * mirrored - coat.g;
            const float way = 1 / std::sqrt(1 - (1 - c * c) / (1.6f * 1.6f));
            for (int i = 0; i < 3; ++i)
                EXPECT_NEAR(all[i] - coat[i],
                            0.5f * passed * (1 - kWeight + kWeight * std::pow(tint[i], way)),
                            0.006f)
                    << alpha << " " << c << " " << i;
        }
}

TEST(LayeredBsdf, MetalsAreSampledWhereTheirEdgeIsBlack) {
    // The facets of rough metal face angles at which it reflects. At the black one itself nothing
    // was drawn without a coat, and little with one.
    const ConductorBsdf whole{Rgb(1), Rgb(0), 0.3f, 0.3f};
    static const CoatTable border(1.5f, 0);
    for (const float weight : {0.0f, 1.0f}) {
        LayeredBsdf layers;
        ConductorBsdf metal = whole;
        metal.schlick = metal_of_edge(Rgb(0.9f), Rgb(0));
        layers.base = metal;
        layers.coat = {weight, 0, {0, 0, 1}, &border};
        const Bsdf bsdf = layers;
        const Vec3 wo = at_cos(1 / 7.0f);
        constexpr int kSide = 40;
        double drawn = 0, most = 0;
        for (int i = 0; i < kSide; ++i)
            for (int j = 0; j < kSide; ++j)
                for (int k = 0; k < kSide; ++k) {
                    const auto at = [](int n) { return (float(n) + 0.5f) / kSide; };
                    const auto s = sample(bsdf, wo, at(k), {at(i), at(j)});
                    if (!s || is_specular(s->lobe)) continue;
                    drawn += double(s->weight.g) / (kSide * kSide * kSide);
                    most = std::max(most, double(s->weight.g));
                }
        const double all = integrated(bsdf, wo).g;
        EXPECT_GT(all, 0.2) << weight;
        EXPECT_NEAR(drawn, all, 0.02 * all) << weight;
        EXPECT_LT(most, 3) << weight;
    }
}

TEST(LayeredBsdf, SmoothCoatMirrorsAboutItsOwnNormal) {
    const Vec3 normal = normalize(Vec3{0.1f, 0.2f, 1}), wo = normalize(Vec3{-0.3f, 0.4f, 1});
    for (const float side : {1.0f, -1.0f}) {
        const Bsdf coated = LayeredBsdf{DiffuseBsdf{Rgb(0.5f)}, {}, {1, 0, normal}};
        const Vec3 from{wo.x, wo.y, side * wo.z}, about{normal.x, normal.y, side * normal.z};
        const auto s = sample(coated, from, 0, {0.5f, 0.5f});
        ASSERT_TRUE(s);
        EXPECT_NEAR(distance(s->wi, about * (2 * dot(from, about)) - from), 0, 1e-5f);
    }
}

TEST(LayeredBsdf, BodiesOfGlassHaveTheirLayersOutside) {
    const DielectricBsdf glass{1.5f, 0.2f, 0.2f};
    const Bsdf plain = glass, coated = LayeredBsdf{glass, {Rgb(1), 0.3f, &table()}, {1, 0.1f}};
    const Vec3 outside = at_cos(0.6f), inside{-0.8f, 0, -0.6f}, mirrored{0.8f, 0, -0.6f};
    EXPECT_FALSE(is_black(eval(plain, inside, mirrored)));
    EXPECT_EQ(eval(coated, inside, mirrored), eval(plain, inside, mirrored));
    for (const Vec3 wi : {Vec3{-0.8f, 0, 0.6f}, normalize(Vec3{-0.53f, 0, -0.85f})}) {
        EXPECT_FALSE(is_black(eval(plain, outside, wi)));
        EXPECT_NE(eval(coated, outside, wi), eval(plain, outside, wi));
    }
}

TEST(LayeredBsdf, AlbedoIsTheIntegral) {
    const Rgb tan(0.7f, 0.5f, 0.2f);
    const Bsdf layered =
        LayeredBsdf{DiffuseBsdf{tan}, {{0.2f, 0.4f, 0.1f}, 0.5f, &table()}, {0.5f, 0.05f}};
    for (const float c : {0.2f, 0.5f, 1.0f}) {
        const Rgb told = albedo(layered, at_cos(c)), found = integrated(layered, at_cos(c));
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(told[i], found[i], 0.06f) << c;
    }
}

}  // namespace
}  // namespace covtrace
