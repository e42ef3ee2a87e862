#include "shading/material.h"

#include <gtest/gtest.h>

#include "bsdf/fresnel.h"
#include "bsdf/hair.h"
#include "shading_fixtures.h"

namespace covtrace {
namespace {

TEST_F(MaterialTest, NoMaterialIsGreyDiffuse) {
    build();
    EXPECT_EQ(bsdf_at<DiffuseBsdf>(-1).reflectance, Rgb(0.5f));
    EXPECT_FALSE(materials_->lets_light_pass(-1));
    EXPECT_EQ(materials_->textures(-1).reflectance, -1);
}

TEST_F(MaterialTest, DiffuseReflectanceIsClamped) {
    const MaterialId id = add(DiffuseMaterial{constant({1.5f, -0.2f, 0.3f})});
    const MaterialId broken = add(DiffuseMaterial{constant({NAN, 0.5f, 0.5f})});
    build();
    EXPECT_EQ(bsdf_at<DiffuseBsdf>(id).reflectance, Rgb(1, 0, 0.3f));
    EXPECT_EQ(bsdf_at<DiffuseBsdf>(broken).reflectance, Rgb(0, 0.5f, 0.5f));
}

TEST_F(MaterialTest, TexturesAreEvaluatedAtTheHit) {
    const TextureId board = checks(constant(0.2f), constant(0.7f));
    const MaterialId textured = add(DiffuseMaterial{board}),
                     plain = add(DiffuseMaterial{constant(0.4f)});
    build();
    EXPECT_EQ(bsdf_at<DiffuseBsdf>(textured, {0.5f, 0.5f}).reflectance, Rgb(0.2f));
    EXPECT_EQ(bsdf_at<DiffuseBsdf>(textured, {1.5f, 0.5f}).reflectance, Rgb(0.7f));
    EXPECT_EQ(bsdf_at<DiffuseBsdf>(plain, {1.5f, 0.5f}).reflectance, Rgb(0.4f));
    EXPECT_EQ(materials_->textures(textured).reflectance, board);
    EXPECT_EQ(materials_->textures(plain).reflectance, -1);
}

TEST_F(MaterialTest, RoughnessIsRemappedAsPbrtDoes) {
    EXPECT_EQ(ggx_alphas(0.25f, 0.04f, true), (Vec2{0.5f, std::sqrt(0.04f)}));
    EXPECT_EQ(ggx_alphas(0.25f, 0.04f, false), (Vec2{0.25f, 0.04f}));
    EXPECT_EQ(ggx_alphas(0, 0, true), (Vec2{0, 0}));
    EXPECT_EQ(ggx_alphas(9e-4f, 9e-4f, false), (Vec2{0, 0}));
    EXPECT_EQ(ggx_alphas(1e-3f, 0, false), (Vec2{1e-3f, 1e-4f}));
    EXPECT_EQ(ggx_alphas(-1, -1, true), (Vec2{0, 0}));
    EXPECT_EQ(ggx_alphas(0.5f, NAN, false), (Vec2{0.5f, 1e-4f}));
    EXPECT_EQ(ggx_alphas(NAN, 0.5f, false), (Vec2{0, 0}));
}

TEST_F(MaterialTest, ConductorTakesIndexOrReflectance) {
    ConductorMaterial gold;
    gold.eta = constant({0.14f, 0.37f, 1.44f});
    gold.k = constant({3.98f, 2.39f, 1.6f});
    gold.u_roughness = constant(0.01f);
    gold.v_roughness = constant(0.09f);
    ConductorMaterial tinted;
    tinted.reflectance = constant({0.9f, 0.5f, 0.0f});
    ConductorMaterial white;
    white.reflectance = constant(1.0f);
    const MaterialId gold_id = add(gold), tinted_id = add(tinted), white_id = add(white);
    build();

    const auto g = bsdf_at<ConductorBsdf>(gold_id);
    EXPECT_EQ(g.eta, Rgb(0.14f, 0.37f, 1.44f));
    EXPECT_EQ(g.k, Rgb(3.98f, 2.39f, 1.6f));
    EXPECT_NEAR(g.alpha_x, 0.1f, 1e-6f);
    EXPECT_NEAR(g.alpha_y, 0.3f, 1e-6f);

    const auto t = bsdf_at<ConductorBsdf>(tinted_id);
    EXPECT_EQ(t.alpha_x, 0);
    const Rgb at_normal = fresnel_conductor(1, t.eta, t.k);
    EXPECT_NEAR(at_normal.r, 0.9f, 1e-5f);
    EXPECT_NEAR(at_normal.g, 0.5f, 1e-5f);
    EXPECT_NEAR(at_normal.b, 0, 1e-5f);

    const auto w = bsdf_at<ConductorBsdf>(white_id);
    EXPECT_TRUE(is_finite(w.k));
    EXPECT_NEAR(fresnel_conductor(1, w.eta, w.k).g, 0.9999f, 1e-5f);
}

TEST_F(MaterialTest, MetalsHaveTheEdgesOfTheirColours) {
    ConductorMaterial even;
    even.reflectance = constant({0.9f, 0.5f, 0.0f});
    even.edge = ConductorMaterial::Edge::none;
    ConductorMaterial tinted = even;
    tinted.edge = ConductorMaterial::Edge::schlick;
    tinted.edge_tint = checks(constant(1.0f), constant({0.5f, NAN, 2.0f}));
    const MaterialId even_id = add(even), tinted_id = add(tinted);
    build();
    const auto same = bsdf_at<ConductorBsdf>(even_id);
    ASSERT_TRUE(same.schlick);
    EXPECT_EQ(same.schlick->grazing, Rgb(0.9f, 0.5f, 0));
    EXPECT_EQ(same.schlick->dip, Rgb(0));
    for (const Vec2 uv : {Vec2{0.5f, 0.5f}, Vec2{1.5f, 0.5f}}) {
        const auto metal = bsdf_at<ConductorBsdf>(tinted_id, uv);
        ASSERT_TRUE(metal.schlick);
        const bool is_first = uv.x < 1;
        const auto expected = metal_of_edge({0.9f, 0.5f, 0}, is_first ? Rgb(1) : Rgb(0.5f, 0, 1));
        EXPECT_EQ(metal.schlick->grazing, Rgb(1));
        EXPECT_EQ(metal.schlick->dip, expected.dip);
    }
}

TEST_F(MaterialTest, MultipleScatteringIsForEveryRoughnessOfATexture) {
    ConductorMaterial white;
    white.reflectance = constant(1.0f);
    white.u_roughness = white.v_roughness = checks(constant(0.25f), constant(1.0f));
    DielectricMaterial glass;
    glass.u_roughness = glass.v_roughness = white.u_roughness;
    CoatedConductorMaterial coated;
    coated.conductor = white;
    ConductorMaterial once = white;
    white.multiple_scattering = glass.multiple_scattering = coated.conductor.multiple_scattering =
        true;
    const MaterialId all_id = add(white), glass_id = add(glass), coated_id = add(coated),
                     once_id = add(once);
    build();
    for (const Vec2 uv : {Vec2{0.5f, 0.5f}, Vec2{1.5f, 0.5f}}) {
        const auto metal = bsdf_at<ConductorBsdf>(all_id, uv);
        EXPECT_EQ(metal.table_row, CoatTable::row_of(metal.alpha_x));
        EXPECT_NEAR(metal.regained.g, 1, 1e-3f);
        EXPECT_FALSE(bsdf_at<ConductorBsdf>(once_id, uv).white);
        const auto border = bsdf_at<DielectricBsdf>(glass_id, uv);
        EXPECT_EQ(border.table_row, CoatTable::row_of(border.alpha_x));
        EXPECT_FLOAT_EQ(border.from_outside->eta(), 1.5f);
        EXPECT_FLOAT_EQ(border.from_inside->eta(), 1 / 1.5f);
        // A coat's index changes what the metal reflects; the coat itself is a plain border.
        const auto below = bsdf_at<CoatedConductorBsdf>(coated_id, uv);
        EXPECT_GT(below.metal.regained.g, 0.9f);
        EXPECT_LT(below.metal.regained.g, metal.regained.g);
        EXPECT_FALSE(below.coat.from_outside);
    }
}

TEST_F(MaterialTest, FilmsOnRoughGlassHaveTheTableOfTheirThickness) {
    DielectricMaterial even, uneven;
    even.u_roughness = even.v_roughness = uneven.u_roughness = uneven.v_roughness = constant(0.5f);
    even.multiple_scattering = uneven.multiple_scattering = true;
    even.film = {1.4f, -1, constant(250.0f)};
    uneven.film = {1.4f, -1, checks(constant(250.0f), constant(350.0f))};
    DielectricMaterial patchy = even, once = even;
    patchy.film->weight = checks(constant(1.0f), constant(0.3f));
    once.multiple_scattering = false;
    const MaterialId even_id = add(even), uneven_id = add(uneven), patchy_id = add(patchy),
                     once_id = add(once);
    build();
    const auto one = bsdf_at<DielectricBsdf>(even_id);
    ASSERT_TRUE(one.under_film);
    EXPECT_EQ(one.under_film->thickness(), 250.0f);
    EXPECT_EQ(one.under_film->film_eta(), 1.4f);
    EXPECT_EQ(bsdf_at<DielectricBsdf>(patchy_id).under_film, one.under_film);
    EXPECT_FALSE(bsdf_at<DielectricBsdf>(once_id).under_film);
    for (const Vec2 uv : {Vec2{0.5f, 0.5f}, Vec2{1.5f, 0.5f}}) {
        const auto any = bsdf_at<DielectricBsdf>(uneven_id, uv);
        ASSERT_TRUE(any.under_film);
        EXPECT_FALSE(any.under_film->thickness());
        EXPECT_EQ(any.film.thickness, uv.x < 1 ? 250.0f : 350.0f);
    }
}

TEST_F(MaterialTest, DielectricWithTexturedRoughness) {
    DielectricMaterial glass;
    glass.eta = 1.33f;
    glass.u_roughness = glass.v_roughness = checks(constant(0.0f), constant(0.25f));
    const MaterialId id = add(glass);
    build();
    EXPECT_TRUE(is_specular(Bsdf(bsdf_at<DielectricBsdf>(id, {0.5f, 0.5f}))));
    EXPECT_EQ(bsdf_at<DielectricBsdf>(id, {1.5f, 0.5f}).alpha_x, 0.5f);
    EXPECT_EQ(bsdf_at<DielectricBsdf>(id, {1.5f, 0.5f}).eta, 1.33f);
    EXPECT_EQ(materials_->textures(id).reflectance, -1);
}

TEST_F(MaterialTest, HairTakesTheFirstDescriptionOfItsPigment) {
    HairMaterial all, coloured, dyed, red;
    all.absorption = constant({0.5f, -1, NAN});
    all.reflectance = coloured.reflectance = constant({0.5f, 1, 0.1f});
    all.eumelanin = coloured.eumelanin = dyed.eumelanin = constant(2);
    all.pheomelanin = coloured.pheomelanin = dyed.pheomelanin = red.pheomelanin = constant(3);
    coloured.beta_n = constant(0.6f);
    const MaterialId all_id = add(all), coloured_id = add(coloured), dyed_id = add(dyed),
                     red_id = add(red), plain_id = add(HairMaterial{});
    build();
    const auto absorption = [&](MaterialId id) { return bsdf_at<HairBsdf>(id).absorption; };
    EXPECT_EQ(absorption(all_id), Rgb(0.5f, 0, 0));
    EXPECT_EQ(absorption(coloured_id), absorption_of_reflectance({0.5f, 1, 0.1f}, 0.6f));
    EXPECT_EQ(absorption(dyed_id), absorption_of_pigments(2, 3));
    EXPECT_EQ(absorption(red_id), absorption_of_pigments(0, 3));
    EXPECT_EQ(absorption(plain_id), absorption_of_pigments(1.3f, 0));
}

TEST_F(MaterialTest, HairHasPbrtsDefaultsAndItsPlaceByV) {
    HairMaterial rough;
    rough.beta_m = checks(constant(0.2f), constant(0.7f));
    rough.coat = constant(0.5f);
    const MaterialId plain_id = add(HairMaterial{}), rough_id = add(rough);
    build();
    const HairBsdf plain = bsdf_at<HairBsdf>(plain_id, {0.3f, 0.25f}),
                   expected = make_hair({}, Rgb(0));
    EXPECT_EQ(plain.offset, -0.5f);
    EXPECT_EQ(plain.eta, 1.55f);
    EXPECT_EQ(plain.variance, expected.variance);
    EXPECT_EQ(plain.scale, expected.scale);
    EXPECT_EQ(plain.sin_tilt, expected.sin_tilt);
    const HairBsdf here = bsdf_at<HairBsdf>(rough_id, {1.5f, 0.5f});
    EXPECT_EQ(here.variance, make_hair({.beta_m = 0.7f, .coat = 0.5f}, Rgb(0)).variance);
    EXPECT_LT(here.variance[0], 4 * here.variance[1]) << "a coat narrows what is reflected";
    EXPECT_EQ(here.offset, 0);
}

TEST_F(MaterialTest, DiffuseTransmissionIsScaledThenClamped) {
    DiffuseTransmissionMaterial leaf;
    leaf.reflectance = checks(constant(0.3f), constant(0.1f));
    leaf.transmittance = constant(0.9f);
    leaf.scale = 2;
    const MaterialId id = add(leaf), standard = add(DiffuseTransmissionMaterial{});
    build();
    EXPECT_EQ(bsdf_at<DiffuseTransmissionBsdf>(id).reflectance, Rgb(0.6f));
    EXPECT_EQ(bsdf_at<DiffuseTransmissionBsdf>(id).transmittance, Rgb(1));
    EXPECT_EQ(bsdf_at<DiffuseTransmissionBsdf>(standard).reflectance, Rgb(0.25f));
    EXPECT_EQ(materials_->textures(id).reflectance, leaf.reflectance);
    EXPECT_EQ(materials_->textures(id).transmittance, -1);
}

TEST_F(MaterialTest, InterfacesAreKnown) {
    const MaterialId id = add(InterfaceMaterial{}), other = add(DiffuseMaterial{});
    build();
    EXPECT_TRUE(materials_->lets_light_pass(id));
    EXPECT_FALSE(materials_->lets_light_pass(other));
    bsdf_at<InterfaceBsdf>(id);
}

TEST(ShadingFrame, FollowsNormalAndParameterisation) {
    SurfaceHit hit;
    hit.ng = {0, 0, 1};
    hit.ns = normalize({0.2f, -0.1f, 1});
    hit.tangent = {3, 0.5f, 0.1f};
    const Frame f = shading_frame(hit);
    EXPECT_EQ(f.z, hit.ns);
    EXPECT_NEAR(dot(f.x, f.z), 0, 1e-6f);
    EXPECT_GT(dot(f.x, hit.tangent), 0);
    EXPECT_NEAR(dot(cross(f.x, f.y), f.z), 1, 1e-6f);
    // A surface without a usable parameterisation still has a frame.
    hit.tangent = {};
    const Frame g = shading_frame(hit);
    EXPECT_NEAR(dot(cross(g.x, g.y), g.z), 1, 1e-6f);
}

}  // namespace
}  // namespace covtrace
