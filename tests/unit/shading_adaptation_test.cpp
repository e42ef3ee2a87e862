/// The colour of a scene's light, and its effect on materials.
#include <gtest/gtest.h>

#include "light_fixtures.h"
#include "shading/material.h"

namespace covtrace::test {
namespace {

void expect_colour(Rgb value, Rgb expected, float relative) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected[c], relative * expected[c]);
}

TEST(LightsPower, NoLightHasNone) {
    LightScene s;
    s.build();
    EXPECT_EQ(s.lights->total_power(), Rgb{});
}

TEST(LightsPower, AreaLightsCountTheirEmittingSides) {
    const Rgb radiance{17, 12, 4};
    for (const bool two_sided : {false, true}) {
        LightScene s;
        s.add(mesh_of(rectangle(2, 3)), radiance, two_sided);
        s.build();
        expect_colour(s.lights->total_power(), (two_sided ? 12 : 6) * kPi * radiance, 1e-5f);
    }
    LightScene sphere;
    sphere.add(shape_of(whole_sphere(2)), radiance);
    sphere.build();
    expect_colour(sphere.lights->total_power(), 16 * kPi * kPi * radiance, 1e-5f);
}

TEST(LightsPower, IsWhatTheFileAsksFor) {
    LightScene s;
    s.add(mesh_of(rectangle(2, 3)), {3, 1, 2});
    s.description.area_lights[0].power = 100.0f;
    s.add_light(PointLight{.intensity = {1, 2, 3}, .power = 30.0f, .from = {}});
    s.add_light(SpotLight{.intensity = {2, 2, 1}, .power = 20.0f, .from = {}});
    s.build();
    EXPECT_NEAR(luminance(s.lights->total_power()), 150, 1e-3);
}

TEST(LightsPower, SpotsFillTheirCone) {
    LightScene s;
    s.add_light(SpotLight{
        .intensity = Rgb(2), .power = {}, .from = {}, .cone_angle = 60, .cone_delta_angle = 0});
    s.build();
    EXPECT_NEAR(s.lights->total_power().g, 2 * 2 * kPi * 0.5f, 1e-4);
}

TEST(LightsPower, InfiniteLightsShineOnTheWholeScene) {
    const float disk = kPi * 3;  // around a cube of side 2
    const auto power_with = [](auto light) {
        LightScene s;
        s.description.shapes.push_back(mesh_of(cube()));
        s.add_light(light);
        s.build();
        return s.lights->total_power();
    };
    expect_colour(power_with(DistantLight{.radiance = {3, 2, 1}}), disk * Rgb{3, 2, 1}, 1e-3f);
    expect_colour(power_with(InfiniteLight{.radiance = {3, 2, 1}, .image = {}, .illuminance = {}}),
                  4 * kPi * disk * Rgb{3, 2, 1}, 1e-3f);
    const TemporaryImage image({Rgb{4, 0, 1}, Rgb{0, 8, 1}, Rgb{0, 0, 1}, Rgb{0, 0, 1}}, 2, 2);
    InfiniteLight picture;
    picture.radiance = Rgb{1, 1, 2};
    picture.image = image.path();
    expect_colour(power_with(picture), 4 * kPi * disk * Rgb{1, 2, 2}, 1e-3f);
}

class AdaptedMaterials : public testing::Test {
  protected:
    TextureId constant(Rgb value) {
        return add({.name = "", .is_spectrum = true, .value = ConstantTexture{value}, .where = {}});
    }
    /// A texture that is `value` everywhere, though it counts as varying.
    TextureId varying(Rgb value) {
        CheckerboardTexture board;
        board.tex1 = constant(value);
        board.tex2 = constant(value + Rgb(0.01f));
        return add({.name = "", .is_spectrum = true, .value = board, .where = {}});
    }
    template <typename B, typename M>
    B adapted(const M& material) {
        scene_.materials = {{.name = "", .value = material, .where = {}}};
        const TextureStore textures(scene_);
        const MaterialStore materials(scene_, textures, light_);
        SurfaceHit hit;
        hit.uv = {0.5f, 0.5f};
        return std::get<B>(materials.bsdf(0, hit, textures));
    }

    const Rgb wall_{0.14f, 0.45f, 0.091f};
    const IlluminantAdaptation light_{{17, 12, 4}};

  private:
    TextureId add(TextureDescription t) {
        scene_.textures.push_back(std::move(t));
        return static_cast<TextureId>(scene_.textures.size()) - 1;
    }
    SceneDescription scene_;
};

TEST_F(AdaptedMaterials, ConstantColoursAreExact) {
    const Rgb expected = light_(wall_);
    ASSERT_NE(expected, wall_);
    EXPECT_EQ(adapted<DiffuseBsdf>(DiffuseMaterial{constant(wall_)}).reflectance, expected);
    DiffuseTransmissionMaterial leaf;
    leaf.reflectance = constant(0.5f * wall_);
    leaf.transmittance = constant(wall_);
    leaf.scale = 2;
    const auto bsdf = adapted<DiffuseTransmissionBsdf>(leaf);
    EXPECT_EQ(bsdf.reflectance, expected);
    EXPECT_EQ(bsdf.transmittance, light_(2 * wall_));
}

TEST_F(AdaptedMaterials, TexturesGoThroughTheTable) {
    const Rgb value = adapted<DiffuseBsdf>(DiffuseMaterial{varying(wall_)}).reflectance;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], light_(wall_)[c], 2e-3);
    EXPECT_NE(value, wall_);
}

TEST_F(AdaptedMaterials, ConductorsAreWhereTheyAreGivenByReflectance) {
    ConductorMaterial tinted;
    tinted.reflectance = constant(wall_);
    const auto bsdf = adapted<ConductorBsdf>(tinted);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(sqr(bsdf.k[c]) / (4 + sqr(bsdf.k[c])), light_(wall_)[c], 1e-5);
    ConductorMaterial metal;
    metal.eta = constant({0.2f, 0.9f, 1.1f});
    metal.k = constant({3.9f, 2.5f, 2.1f});
    EXPECT_EQ(adapted<ConductorBsdf>(metal).k, Rgb(3.9f, 2.5f, 2.1f));
}

TEST_F(AdaptedMaterials, CoatsTakeTheBaseAgainByItsSpectrum) {
    CoatedDiffuseMaterial coated;
    coated.reflectance = constant(wall_);
    const auto fixed = adapted<CoatedDiffuseBsdf>(coated);
    CoatTables tables;
    const CoatTable& coat = tables.get(coated.eta, 0.01f);
    const Rgb expected =
        sum_of_bounces(reflectance_powers(wall_, light_),
                       coat.internal_reflectance(fixed.table_row), (coated.max_depth + 1) / 2) *
        (kInvPi / sqr(coated.eta));
    EXPECT_EQ(fixed.base, expected);
    // Each material needs a lookup at every hit: the first of its colour, the second of its
    // roughness alone.
    CoatedDiffuseMaterial textured = coated, rough = coated;
    textured.reflectance = varying(wall_);
    rough.u_roughness = rough.v_roughness = varying(Rgb(0));
    EXPECT_EQ(adapted<CoatedDiffuseBsdf>(rough).base, expected);
    const Rgb looked_up = adapted<CoatedDiffuseBsdf>(textured).base;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(looked_up[c], expected[c], 2e-3);
    EXPECT_NE(looked_up, expected);
}

TEST_F(AdaptedMaterials, DefaultsAreGreyAndStay) {
    EXPECT_EQ(adapted<DiffuseBsdf>(DiffuseMaterial{}).reflectance, Rgb(0.5f));
    const auto leaf = adapted<DiffuseTransmissionBsdf>(DiffuseTransmissionMaterial{});
    EXPECT_EQ(leaf.reflectance, Rgb(0.25f));
    EXPECT_EQ(leaf.transmittance, Rgb(0.25f));
}

}  // namespace
}  // namespace covtrace::test
