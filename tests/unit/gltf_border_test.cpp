// Reflectance of the borders of glTF's materials reflect: KHR_materials_specular,
// -pbrSpecularGlossiness and -anisotropy, as descriptions. The values are held against Khronos's
// formulas in tests/cli/test_gltf_materials.py.
#include "gltf_fixtures.h"
#include "scene/dispersion.h"

namespace covtrace::test {
namespace {

const std::string kImage = "any bytes: images are decoded by what renders them";

/// The square with one material of some extensions that is no metal, and one texture.
SceneDescription with_extensions(const json& extensions, float roughness = 1) {
    GltfFile file;
    file.root["images"] = {{{"bufferView", file.add_view(kImage)}, {"mimeType", "image/png"}}};
    file.root["textures"] = {{{"source", 0}}};
    file.root["materials"] = {
        {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", roughness}}},
         {"extensions", extensions}}};
    file.add_node({{"mesh", file.add_square({{"material", 0}})}});
    return read(file);
}
const CoatedDiffuseMaterial& coat_of(const SceneDescription& scene) {
    return model_of<CoatedDiffuseMaterial>(scene, scene.shapes[0].material);
}

TEST(GltfBorder, IsThatOfTheIndexWithoutExtensions) {
    for (const json& nothing :
         {json::object(), json{{"KHR_materials_specular", json::object()}},
          json{{"KHR_materials_ior", {{"ior", 1}}},
               {"KHR_materials_specular", {{"specularColorFactor", {9, 9, 9}}}}},
          json{{"KHR_materials_anisotropy", {{"anisotropyRotation", 1}}}}}) {
        const auto scene = with_extensions(nothing);
        EXPECT_EQ(coat_of(scene).normal_reflectance, -1);
        EXPECT_EQ(coat_of(scene).coat_weight, -1);
        EXPECT_EQ(coat_of(scene).u_roughness, coat_of(scene).v_roughness);
        EXPECT_EQ(scene.materials[0].tangent_rotation, 0);
    }
}

TEST(GltfBorder, SpecularKeepsColoursAndTextures) {
    const auto scene = with_extensions({{"KHR_materials_specular",
                                         {{"specularFactor", 0.5},
                                          {"specularTexture", {{"index", 0}}},
                                          {"specularColorFactor", {1, 2, 4}},
                                          {"specularColorTexture", {{"index", 0}}}}}});
    const auto& coat = coat_of(scene);
    EXPECT_EQ(coat.eta, 1.5f);
    const auto& weight = constant_as<ImageTexture>(scene, coat.coat_weight);
    EXPECT_EQ(weight.channel, ImageTexture::Channel::alpha);
    EXPECT_EQ(weight.scale, 0.5f);
    const auto& product = constant_as<ScaleTexture>(scene, coat.normal_reflectance);
    EXPECT_EQ(constant_as<ImageTexture>(scene, product.tex).encoding, ImageTexture::Encoding::srgb);
    expect_near(constant_value(scene, product.scale), {0.04f, 0.08f, 0.16f}, 1e-6f);
    EXPECT_FALSE(contains(all_warnings(scene), "KHR_materials_specular"));
}

TEST(GltfBorder, FilmsKeepTheirNumbersAndTextures) {
    const auto film = [](const json& iridescence) {
        return coat_of(with_extensions({{"KHR_materials_iridescence", iridescence}})).film;
    };
    EXPECT_FALSE(film({{"iridescenceIor", 2}})) << "the factor is 0 unless it is given";
    const auto scene = with_extensions({{"KHR_materials_iridescence",
                                         {{"iridescenceFactor", 0.5},
                                          {"iridescenceIor", 1.8},
                                          {"iridescenceThicknessMinimum", 50}}}});
    const auto& plain = coat_of(scene).film.value();
    EXPECT_EQ(plain.eta, 1.8f);
    EXPECT_EQ(constant_value(scene, plain.weight).r, 0.5f);
    EXPECT_EQ(constant_value(scene, plain.thickness).r, 400);
    EXPECT_FALSE(contains(all_warnings(scene), "iridescence"));
    const auto textured = with_extensions({{"KHR_materials_iridescence",
                                            {{"iridescenceFactor", 1},
                                             {"iridescenceTexture", {{"index", 0}}},
                                             {"iridescenceThicknessMaximum", 600},
                                             {"iridescenceThicknessTexture", {{"index", 0}}}}}});
    const auto& image = coat_of(textured).film.value();
    EXPECT_EQ(constant_as<ImageTexture>(textured, image.weight).channel,
              ImageTexture::Channel::red);
    const auto& mixture = constant_as<MixTexture>(textured, image.thickness);
    EXPECT_EQ(constant_value(textured, mixture.tex1).r, 100);
    EXPECT_EQ(constant_value(textured, mixture.tex2).r, 600);
    EXPECT_EQ(constant_as<ImageTexture>(textured, mixture.amount).channel,
              ImageTexture::Channel::green);
}

TEST(GltfBorder, WhatTransmitsLightKeepsItsFilm) {
    const auto film = [](const auto& material) { return material.film.value().eta; };
    json extensions{
        {"KHR_materials_iridescence", {{"iridescenceFactor", 1}, {"iridescenceIor", 1.8}}},
        {"KHR_materials_transmission", {{"transmissionFactor", 1}}}};
    json of_body = extensions;
    of_body["KHR_materials_volume"] = {{"thicknessFactor", 1}};
    const auto border = with_extensions(of_body);
    EXPECT_EQ(film(model_of<DielectricMaterial>(border, border.shapes[0].material)), 1.8f);
    EXPECT_FALSE(contains(all_warnings(border), "iridescence"));
    const auto pane = with_extensions(extensions, 0);
    EXPECT_EQ(film(model_of<ThinDielectricMaterial>(pane, pane.shapes[0].material)), 1.8f);
    EXPECT_FALSE(contains(all_warnings(pane), "iridescence"));
}

TEST(GltfBorder, WhatTransmitsLightTakesTheMean) {
    const auto eta = [](double ior, const json& specular) {
        const auto scene =
            with_extensions({{"KHR_materials_ior", {{"ior", ior}}},
                             {"KHR_materials_specular", specular},
                             {"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                             {"KHR_materials_volume", {{"thicknessFactor", 1}}}});
        EXPECT_TRUE(contains(all_warnings(scene), "colours become their mean"));
        return model_of<DielectricMaterial>(scene, scene.shapes[0].material).eta;
    };
    // Half of an amplitude is a quarter of the light.
    EXPECT_NEAR(eta(1000, {{"specularFactor", 0.25}}), 2.994f, 1e-2f);
    EXPECT_NEAR(eta(1.5, {{"specularColorFactor", {1e9, 1e9, 1e9}}}), 1000, 1);
}

TEST(GltfBorder, BodiesDisperse) {
    const auto glass = [](double ior, double strength) {
        const auto scene =
            with_extensions({{"KHR_materials_ior", {{"ior", ior}}},
                             {"KHR_materials_dispersion", {{"dispersion", strength}}},
                             {"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                             {"KHR_materials_volume", {{"thicknessFactor", 1}}}});
        EXPECT_FALSE(contains(all_warnings(scene), "KHR_materials_dispersion"));
        return model_of<DielectricMaterial>(scene, scene.shapes[0].material);
    };
    EXPECT_EQ(glass(1.5, 0).dispersion, nullptr);
    EXPECT_EQ(glass(1, 1).dispersion, nullptr);
    // Diamond, whose Abbe number is 55, and the extension's exaggerated 10.
    for (const double abbe : {55.0, 10.0}) {
        const DielectricMaterial m = glass(2.4, 20 / abbe);
        ASSERT_NE(m.dispersion, nullptr);
        const auto index = [&](float nm) { return m.eta * m.dispersion->at(nm); };
        EXPECT_NEAR(index(587.6f), 2.4f, 1e-3f);
        EXPECT_NEAR((index(587.6f) - 1) / (index(486.1f) - index(656.3f)), abbe, 0.01 * abbe);
    }
    // No index falls below that of empty space.
    EXPECT_EQ(1.2f * glass(1.2, 500).dispersion->at(700), 1);
}

TEST(GltfBorder, SpecularGlossinessTakesThePlaceOfMetallicRoughness) {
    const json factors = {{"diffuseFactor", {0.1, 0.2, 0.3, 0.4}},
                          {"specularFactor", {0.5, 0.6, 0.7}},
                          {"glossinessFactor", 0.75}};
    const auto plain = with_extensions({{"KHR_materials_pbrSpecularGlossiness", factors}});
    const auto& coat = coat_of(plain);
    expect_near(constant_value(plain, coat.reflectance), {0.1f, 0.2f, 0.3f}, 1e-6f);
    expect_near(constant_value(plain, coat.normal_reflectance), {0.5f, 0.6f, 0.7f}, 1e-6f);
    EXPECT_TRUE(coat.coat_dims_base);
    const auto& squared = constant_as<ScaleTexture>(plain, coat.u_roughness);
    EXPECT_EQ(squared.tex, squared.scale);
    EXPECT_FLOAT_EQ(constant_value(plain, squared.tex).r, 0.25f);
    EXPECT_EQ(plain.shapes[0].alpha, -1);  // OPAQUE

    json textured = factors;
    textured["specularGlossinessTexture"] = {{"index", 0}};
    const auto scene = with_extensions({{"KHR_materials_pbrSpecularGlossiness", textured}});
    const auto& width = constant_as<ScaleTexture>(scene, coat_of(scene).u_roughness);
    const auto& roughness = constant_as<ImageTexture>(scene, width.tex);
    EXPECT_EQ(roughness.channel, ImageTexture::Channel::alpha);
    EXPECT_EQ(roughness.encoding, ImageTexture::Encoding::linear);
    EXPECT_EQ(roughness.scale, 0.75f);
    EXPECT_TRUE(roughness.invert);
}

TEST(GltfBorder, AnisotropyWidensTheTangentsSide) {
    const auto scene = with_extensions({{"KHR_materials_anisotropy",
                                         {{"anisotropyStrength", 0.5},
                                          {"anisotropyRotation", 7},
                                          {"anisotropyTexture", {{"index", 0}}}}}});
    const auto& coat = coat_of(scene);
    const auto& width = constant_as<MixTexture>(scene, coat.u_roughness);
    EXPECT_EQ(width.tex1, coat.v_roughness);
    EXPECT_EQ(constant_value(scene, width.tex2).r, 1);
    const auto& squared = constant_as<ScaleTexture>(scene, width.amount);
    EXPECT_EQ(squared.tex, squared.scale);
    const auto& strength = constant_as<ImageTexture>(scene, squared.tex);
    EXPECT_EQ(strength.channel, ImageTexture::Channel::blue);
    EXPECT_EQ(strength.scale, 0.5f);
    const MaterialDescription& m = scene.materials[size_t(scene.shapes[0].material)];
    EXPECT_NEAR(m.tangent_rotation, 7 - 2 * std::acos(-1), 1e-6f);
    EXPECT_FALSE(constant_as<ImageTexture>(scene, m.tangent_direction).is_colour);
}

}  // namespace
}  // namespace covtrace::test
