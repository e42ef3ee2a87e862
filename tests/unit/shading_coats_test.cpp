#include <cmath>

#include "shading_fixtures.h"

namespace covtrace {
namespace {

class CoatedMaterialTest : public MaterialTest {};

TEST_F(CoatedMaterialTest, CoatedDiffuseHonoursDepthAndSharesTables) {
    CoatedDiffuseMaterial paint;
    paint.reflectance = constant(0.8f);
    CoatedDiffuseMaterial shallow = paint;
    shallow.max_depth = 2;
    CoatedDiffuseMaterial thick = paint;
    thick.thickness = constant(0.5f);
    const MaterialId paint_id = add(paint), shallow_id = add(shallow), thick_id = add(thick);
    build();
    const auto p = bsdf_at<CoatedDiffuseBsdf>(paint_id), s = bsdf_at<CoatedDiffuseBsdf>(shallow_id),
               t = bsdf_at<CoatedDiffuseBsdf>(thick_id);
    EXPECT_EQ(p.table, s.table);
    EXPECT_NE(p.table, t.table);
    EXPECT_EQ(p.table->thickness(), 0.01f);
    EXPECT_EQ(t.table->thickness(), 0.5f);
    // The base reflects once instead of five times: the series stops after its first term.
    const float again = 0.8f * p.table->internal_reflectance(0);
    EXPECT_NEAR(p.base.g / s.base.g, (1 - std::pow(again, 5.0f)) / (1 - again), 1e-5f);
    EXPECT_LT(albedo(Bsdf(t), {0, 0, 1}).g, albedo(Bsdf(p), {0, 0, 1}).g);
    EXPECT_TRUE(materials_->warnings().empty());
}

TEST_F(CoatedMaterialTest, WhatTheGapCantDoIsWarnedOf) {
    CoatedDiffuseMaterial uneven, foggy;
    uneven.thickness = foggy.thickness = checks(constant(0.1f), constant(0.2f));
    foggy.albedo = constant(0.5f);
    const MaterialId uneven_id = add(uneven);
    add(foggy);
    scene_.materials[0].where.line = 7;
    build();
    ASSERT_EQ(materials_->warnings().size(), 1u);
    EXPECT_EQ(materials_->warnings()[0].where.line, 7);
    EXPECT_NE(materials_->warnings()[0].text.find("thickness"), std::string::npos);
    EXPECT_EQ(bsdf_at<CoatedDiffuseBsdf>(uneven_id).table->thickness(), 0.1f);
}

TEST_F(CoatedMaterialTest, WhatScattersInTheGapIsThatOfTheTextures) {
    CoatedDiffuseMaterial paint;
    CoatedConductorMaterial metal, bare;
    paint.albedo = metal.albedo = bare.albedo = constant({0.5f, 2, NAN});
    paint.g = constant(0.3f);
    metal.g = constant(7);
    paint.thickness = metal.thickness = constant(0.4f);
    bare.thickness = constant(-1);
    paint.max_depth = 20;
    const MaterialId paint_id = add(paint), metal_id = add(metal), bare_id = add(bare);
    build();
    EXPECT_TRUE(materials_->warnings().empty());
    const auto p = bsdf_at<HazyDiffuseBsdf>(paint_id);
    EXPECT_EQ(p.gap.albedo, Rgb(0.5f, 1, 0));
    EXPECT_EQ(p.gap.g, 0.3f);
    EXPECT_EQ(p.gap.events, 20);
    EXPECT_EQ(p.thickness, 0.4f);
    const auto m = bsdf_at<CoatedConductorBsdf>(metal_id);
    EXPECT_TRUE(m.gap.scatters());
    EXPECT_EQ(m.gap.g, 0.99f);
    EXPECT_FALSE(bsdf_at<CoatedConductorBsdf>(bare_id).gap.scatters());
}

TEST_F(CoatedMaterialTest, GapsKeepTheSpectraOfColoursThatDoNotVary) {
    const TextureId orange = constant({0.9f, 0.5f, 0.2f}), grey = constant(0.5f);
    const auto paint = [&](TextureId albedo, TextureId reflectance) {
        CoatedDiffuseMaterial m;
        m.albedo = albedo;
        m.reflectance = reflectance;
        return add(m);
    };
    CoatedConductorMaterial metal;
    metal.albedo = orange;
    const TextureId varying = checks(orange, grey);
    const MaterialId coloured = paint(orange, grey), on_colour = paint(grey, orange),
                     all_grey = paint(grey, grey), uneven = paint(varying, orange),
                     on_uneven = paint(orange, varying), coated_metal = add(metal);
    build();
    const auto spectrum = [&](MaterialId id) { return bsdf_at<HazyDiffuseBsdf>(id).gap.spectrum; };
    ASSERT_TRUE(spectrum(coloured) && spectrum(on_colour) && spectrum(on_uneven));
    EXPECT_EQ(spectrum(coloured)->albedo, band_values({0.9f, 0.5f, 0.2f}));
    EXPECT_EQ(spectrum(coloured)->base, band_values(Rgb(0.5f)));
    EXPECT_EQ(spectrum(on_colour)->base, band_values({0.9f, 0.5f, 0.2f}));
    EXPECT_TRUE(spectrum(on_colour)->has_base);
    EXPECT_FALSE(spectrum(on_uneven)->has_base);
    EXPECT_EQ(spectrum(all_grey), nullptr);
    EXPECT_EQ(spectrum(uneven), nullptr);
    const auto* under_metal = bsdf_at<CoatedConductorBsdf>(coated_metal).gap.spectrum;
    ASSERT_TRUE(under_metal);
    EXPECT_FALSE(under_metal->has_base);
}

TEST_F(CoatedMaterialTest, WalksUnderACoatAreThoseOfTheirPlace) {
    // The scene is parallel light on a plane in an orthographic view: one pair of directions
    // everywhere. Light that one walk misses must not be missed at all places, and a place keeps
    // its walk.
    CoatedConductorMaterial m;
    m.samples = 1;
    m.u_roughness = m.v_roughness = constant(0.3f);
    m.conductor.u_roughness = m.conductor.v_roughness = constant(0.4f);
    m.conductor.reflectance = constant(0.8f);
    const MaterialId one = add(m);
    m.samples = 1 << 18;
    const MaterialId many = add(m);
    build();
    const Vec3 wo = normalize({0.3f, 0, 1}), wi = normalize({-0.5f, 0.2f, 1});
    const auto value = [&](MaterialId id, float x) {
        SurfaceHit hit;
        hit.position = {x, 1, 0};
        const Bsdf bsdf = materials_->bsdf(id, hit, *textures_);
        const double v = eval(bsdf, wo, wi).r;
        if (id == one) {
            EXPECT_NEAR(v / wi.z, eval(bsdf, wi, wo).r / wo.z, 1e-5 * v);
        }
        return v;
    };
    EXPECT_EQ(value(one, 7), value(one, 7));
    const double expected = value(many, 0);
    constexpr int kPlaces = 1 << 14;
    double sum = 0, square = 0;
    for (int i = 0; i < kPlaces; ++i) {
        const double v = value(one, float(i) / kPlaces);
        sum += v;
        square += v * v;
    }
    const double mean = sum / kPlaces;
    const double deviation = std::sqrt(square / kPlaces - mean * mean);
    EXPECT_GT(deviation, 0.05 * expected);
    // The test fails by chance with 1e-5.
    EXPECT_NEAR(mean, expected, 4.5 * deviation / std::sqrt(double(kPlaces)));
}

}  // namespace
}  // namespace covtrace
