/// Parameters of materials that are ours and not pbrt's.
#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

TEST(OwnParameters, LightOfSeveralFacets) {
    const std::string on = " \"bool multiplescattering\" true";
    EXPECT_FALSE(model_of<ConductorMaterial>("\"conductor\"").multiple_scattering);
    EXPECT_TRUE(model_of<ConductorMaterial>("\"conductor\"" + on).multiple_scattering);
    EXPECT_TRUE(model_of<DielectricMaterial>("\"dielectric\"" + on).multiple_scattering);
    EXPECT_TRUE(contains(warnings_of(material_of("\"diffuse\"" + on).scene), "multiplescattering"));
    const std::string coated = "\"coateddiffuse\"" + on,
                      total = " \"bool reflectsthroughcoat\" true",
                      tint = " \"rgb normalreflectance\" [ .1 .2 .3 ]";
    EXPECT_TRUE(model_of<CoatedDiffuseMaterial>(coated + total).multiple_scattering);
    // A coat of layers, and one of a colour, have no such light.
    for (const std::string& without : {coated, coated + total + tint}) {
        EXPECT_FALSE(model_of<CoatedDiffuseMaterial>(without).multiple_scattering);
        EXPECT_TRUE(contains(warnings_of(material_of(without).scene), "multiplescattering"));
    }
    const auto tinted = material_of("\"coateddiffuse\"" + total + tint);
    EXPECT_EQ(
        constant_value(tinted.scene,
                       std::get<CoatedDiffuseMaterial>(tinted.material.value).normal_reflectance),
        (Rgb{0.1f, 0.2f, 0.3f}));
}

TEST(OwnParameters, EdgesOfMetals) {
    using Edge = ConductorMaterial::Edge;
    const std::string grey = "\"conductor\" \"rgb reflectance\" [ .5 .5 .5 ]";
    EXPECT_EQ(model_of<ConductorMaterial>(grey).edge, Edge::of_index);
    EXPECT_EQ(model_of<ConductorMaterial>(grey + " \"string edge\" \"none\"").edge, Edge::none);
    const auto made =
        material_of(grey + " \"string edge\" \"schlick\" \"rgb edgetint\" [ .7 .2 .1 ]");
    const auto& m = std::get<ConductorMaterial>(made.material.value);
    EXPECT_EQ(m.edge, Edge::schlick);
    EXPECT_EQ(constant_value(made.scene, m.edge_tint), (Rgb{0.7f, 0.2f, 0.1f}));
    EXPECT_TRUE(made.scene.warnings.empty());
}

TEST(OwnParameters, FilmsOnClearGlass) {
    const std::string film = " \"float filmthickness\" 350 \"float filmeta\" 1.8";
    const auto of = [](const auto& m) { return m.film.value().eta; };
    EXPECT_EQ(of(model_of<DielectricMaterial>("\"dielectric\"" + film)), 1.8f);
    EXPECT_EQ(of(model_of<ThinDielectricMaterial>("\"thindielectric\"" + film)), 1.8f);
    EXPECT_FALSE(model_of<DielectricMaterial>("\"dielectric\"").film);
    EXPECT_TRUE(material_of("\"dielectric\"" + film).scene.warnings.empty());
}

TEST(OwnParameters, ClearCoats) {
    const auto made = material_of(
        "\"diffuse\" \"float coat\" .6 \"float coatroughness\" .04 \"float coateta\" 1.7\n"
        "\"rgb coattint\" [ .7 .2 .1 ]");
    ASSERT_TRUE(made.material.clearcoat);
    const ClearcoatLayer& coat = *made.material.clearcoat;
    EXPECT_EQ(constant_value(made.scene, coat.weight), Rgb{0.6f});
    EXPECT_EQ(constant_value(made.scene, coat.alpha), Rgb{0.04f});
    EXPECT_EQ(constant_value(made.scene, coat.tint), (Rgb{0.7f, 0.2f, 0.1f}));
    EXPECT_EQ(coat.eta, 1.7f);
    EXPECT_TRUE(made.scene.warnings.empty());
    EXPECT_FALSE(material_of("\"diffuse\"").material.clearcoat);
    EXPECT_EQ(material_of("\"diffuse\" \"float coat\" 1").material.clearcoat->eta, 1.5f);
}

}  // namespace
}  // namespace covtrace::test
