/// Known values: furnaces, mirrors, and the limits that rough models approach.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <memory>
#include <new>

#include "bsdf/coat_table.h"
#include "bsdf/fresnel.h"
#include "core/rng.h"
#include "core/warp.h"

namespace covtrace {
namespace {

/// Energy that leaves for a unit of light: the mean weight with the radiance factor undone.
double furnace(const Bsdf& bsdf, Vec3 wo, int side = 64) {
    Rng rng(3);
    double sum = 0;
    const int n = side * side;
    for (int i = 0; i < n; ++i) {
        const Vec2 u{(static_cast<float>(i % side) + 0.5f) / static_cast<float>(side),
                     (static_cast<float>(i / side) + 0.5f) / static_cast<float>(side)};
        const auto s = sample(bsdf, wo, rng.next_float(), u);
        if (s) sum += s->weight.g * sqr(s->eta);
    }
    return sum / n;
}

Vec3 at_cos(float cos_theta) {
    return {std::sqrt(1 - cos_theta * cos_theta), 0, cos_theta};
}

TEST(BsdfLimits, WhiteFurnace) {
    for (float cos_o : {1.0f, 0.5f, 0.1f, -0.1f, -0.8f}) {
        const Vec3 wo = at_cos(cos_o);
        EXPECT_NEAR(furnace(DiffuseBsdf{Rgb(1)}, wo), 1, 1e-3);
        EXPECT_NEAR(furnace(DielectricBsdf{1.5f}, wo), 1, 1e-3);
        EXPECT_NEAR(furnace(DielectricBsdf{1, 0.5f, 0.5f}, wo), 1, 1e-3);
        EXPECT_NEAR(furnace(InterfaceBsdf{}, wo), 1, 1e-3);
        EXPECT_NEAR(furnace(DiffuseTransmissionBsdf{Rgb(0.5f), Rgb(0.5f)}, wo), 1, 1e-3);
    }
}

TEST(BsdfLimits, MirrorReflectsWithFresnel) {
    const ConductorBsdf silver{Rgb(0.155f), Rgb(3.4f)};
    const Vec3 wo = normalize({0.3f, -0.5f, 0.4f});
    for (Vec3 w : {wo, Vec3{wo.x, wo.y, -wo.z}}) {
        const auto s = sample(Bsdf(silver), w, 0.3f, {0.2f, 0.8f});
        ASSERT_TRUE(s);
        EXPECT_EQ(s->wi, (Vec3{-w.x, -w.y, w.z}));
        EXPECT_EQ(s->weight.r, fresnel_conductor(wo.z, 0.155f, 3.4f));
        EXPECT_EQ(s->pdf, 1);
    }
}

TEST(BsdfLimits, GlassRefractsBySnellFromBothSides) {
    const Bsdf glass = DielectricBsdf{1.5f};
    const Vec3 outside = at_cos(0.6f);
    const auto in = sample(glass, outside, 0.99f, {});
    ASSERT_TRUE(in);
    EXPECT_EQ(in->lobe, LobeKind::specular_transmission);
    EXPECT_NEAR(in->wi.x, -0.8f / 1.5f, 1e-6f);
    EXPECT_LT(in->wi.z, 0);
    EXPECT_NEAR(in->weight.r, 1 / 2.25f, 1e-6f);
    EXPECT_EQ(in->eta, 1.5f);
    const auto out = sample(glass, in->wi, 0.99f, {});
    ASSERT_TRUE(out);
    EXPECT_NEAR(distance(out->wi, outside), 0, 1e-6f);
    EXPECT_NEAR(out->weight.r * in->weight.r, 1, 1e-5f);
    EXPECT_NEAR(out->pdf, in->pdf, 1e-5f);
    // Beyond the critical angle everything is reflected.
    const auto total = sample(glass, at_cos(-0.5f), 0.99999f, {});
    ASSERT_TRUE(total);
    EXPECT_EQ(total->lobe, LobeKind::specular_reflection);
    EXPECT_EQ(total->pdf, 1);
}

TEST(BsdfLimits, MatchedIndicesLetLightPassStraight) {
    const Vec3 wo = at_cos(0.3f);
    const auto s = sample(Bsdf(DielectricBsdf{1, 0.2f, 0.2f}), wo, 0, {});
    ASSERT_TRUE(s);
    EXPECT_NEAR(distance(s->wi, -wo), 0, 1e-6f);
    EXPECT_EQ(s->weight, Rgb(1));
}

// The narrowest lobes must do as the mirror does: same energy, same direction.
TEST(BsdfLimits, RoughModelsApproachSmoothOnes) {
    Rng rng(4);
    constexpr float kAlpha = 0.001f;
    for (float cos_o : {0.95f, 0.6f, 0.3f, -0.3f, -0.6f, -0.9f}) {
        const Vec3 wo = at_cos(cos_o);
        const Bsdf smooth_glass = DielectricBsdf{1.5f},
                   rough_glass = DielectricBsdf{1.5f, kAlpha, kAlpha};
        EXPECT_NEAR(furnace(rough_glass, wo), 1, 1e-3);
        const ConductorBsdf mirror{Rgb(0.2f), Rgb(3.9f)};
        const Bsdf rough_mirror = ConductorBsdf{mirror.eta, mirror.k, kAlpha, kAlpha};
        EXPECT_NEAR(furnace(rough_mirror, wo), furnace(Bsdf(mirror), wo), 1e-3);
        for (float u_lobe : {0.0f, 0.9999f}) {
            const auto sharp = sample(smooth_glass, wo, u_lobe, {});
            int near = 0;
            for (int i = 0; i < 1000; ++i) {
                const auto s = sample(rough_glass, wo, u_lobe, rng.next_2d());
                if (s && distance(s->wi, sharp->wi) < 0.05f) ++near;
            }
            EXPECT_GT(near, 980) << "cos " << cos_o;
        }
    }
}

TEST(BsdfLimits, CoatWithoutIndexIsTheBase) {
    const CoatTable nothing(1, 0);
    const Bsdf coated = make_coated_diffuse(nothing, reflectance_powers(Rgb(0.6f)), 0.2f, 0.2f, 5);
    const Bsdf bare = DiffuseBsdf{Rgb(0.6f)};
    for (float cos_i : {0.1f, 0.5f, 0.9f}) {
        const Vec3 wo = at_cos(0.7f), wi = at_cos(cos_i);
        EXPECT_NEAR(eval(coated, wo, wi).r, eval(bare, wo, wi).r, 1e-4f * eval(bare, wo, wi).r);
        EXPECT_NEAR(pdf(coated, wo, wi), pdf(bare, wo, wi), 1e-4f);
    }
}

// A smooth coat with an empty gap over a white base must give everything back, as nothing absorbs.
TEST(BsdfLimits, WhiteBaseUnderSmoothCoatKeepsAllEnergy) {
    for (float eta : {1.2f, 1.5f, 2.0f, 0.8f}) {
        const CoatTable table(eta, 0);
        const Bsdf coated = make_coated_diffuse(table, reflectance_powers(Rgb(1)), 0, 0, 200);
        for (float cos_o : {1.0f, 0.6f, 0.2f, 0.05f, -0.5f})
            EXPECT_NEAR(albedo(coated, at_cos(cos_o)).g, 1, 1.5e-3f)
                << "eta " << eta << " cos " << cos_o;
    }
}

TEST(BsdfLimits, CoatedAlbedoIsTheIntegralOfEval) {
    const CoatTable table(1.5f, 0.01f);
    for (float alpha : {0.1f, 0.3f, 0.8f}) {
        const Bsdf coated =
            make_coated_diffuse(table, reflectance_powers(Rgb(0.6f)), alpha, alpha, 5);
        for (float cos_o : {0.99f, 0.6f, 0.2f}) {
            const Vec3 wo = at_cos(cos_o);
            constexpr int n = 500;
            double sum = 0;
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    const float z = (static_cast<float>(i) + 0.5f) / n, r = std::sqrt(1 - z * z);
                    const float phi = 2 * kPi * (static_cast<float>(j) + 0.5f) / n;
                    sum += eval(coated, wo, {r * std::cos(phi), r * std::sin(phi), z}).g;
                }
            sum *= 2 * M_PI / n / n;
            EXPECT_NEAR(albedo(coated, wo).g, sum, 3e-3 * sum) << alpha << " " << cos_o;
        }
    }
}

TEST(BsdfLimits, DiffuseInternalReflectanceOfGlassIsTheKnownOne) {
    // The formula is 1 - (1 - F_out) / eta^2 with the known diffuse reflectance 0.0918 of an index
    // of 1.5.
    const CoatTable table(1.5f, 0);
    EXPECT_NEAR(table.internal_reflectance(0), 0.5963f, 5e-4f);
    EXPECT_NEAR(table.mean_transmission(0), 1 - 0.0918f, 5e-4f);
}

TEST(BsdfLimits, CoatTableDoesNotDependOnTheMemoryItLiesIn) {
    // Storage is full of NaN: reading an entry that has not been filled yet would show.
    alignas(CoatTable) std::array<std::byte, sizeof(CoatTable)> storage;
    storage.fill(std::byte{0xff});
    const CoatTable* dirty = new (storage.data()) CoatTable(1.5f, 0.01f);
    const CoatTable clean(1.5f, 0.01f);
    for (int row = 0; row < CoatTable::kRows; ++row) {
        const float r = static_cast<float>(row);
        EXPECT_EQ(dirty->mean_transmission(r), clean.mean_transmission(r));
        EXPECT_EQ(dirty->internal_reflectance(r), clean.internal_reflectance(r));
        for (float cos_theta : {0.0f, 0.3f, 1.0f}) {
            const CoatTable::Shares a = dirty->shares(r, cos_theta), b = clean.shares(r, cos_theta);
            EXPECT_EQ(a.transmission, b.transmission);
            EXPECT_EQ(a.reflection, b.reflection);
        }
    }
    std::destroy_at(dirty);
}

TEST(BsdfLimits, CoatTablesAreSharedByEqualCoats) {
    CoatTables tables;
    const CoatTable& a = tables.get(1.5f, 0.01f);
    const CoatTable& b = tables.get(1.33f, 0.01f);
    EXPECT_EQ(&a, &tables.get(1.5f, 0.01f));
    EXPECT_NE(&a, &b);
}

}  // namespace
}  // namespace covtrace
