// KHR_materials_transmission: panes, clear and frosted, and bodies.
#include "gltf_fixtures.h"

namespace covtrace::test {
namespace {

/// The square with a material that transmits all light, and its extensions beside that.
SceneDescription transmitting(double roughness, const json& extensions = json::object()) {
    GltfFile file;
    json all = {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}};
    all.update(extensions);
    file.root["materials"] = {{{"pbrMetallicRoughness",
                                {{"metallicFactor", 0},
                                 {"roughnessFactor", roughness},
                                 {"baseColorFactor", {0.5, 1, 1, 1}}}},
                               {"extensions", all}}};
    file.add_node({{"mesh", file.add_square({{"material", 0}})}});
    return read(file);
}

TEST(GltfTransmission, WithoutAVolumeIsAPane) {
    const auto pane = transmitting(0, {{"KHR_materials_ior", {{"ior", 1.4}}}});
    const auto& thin = model_of<ThinDielectricMaterial>(pane, pane.shapes[0].material);
    EXPECT_NEAR(thin.eta, 1.4f, 1e-6f);
    expect_near(constant_value(pane, thin.transmittance), {0.5f, 1, 1}, 0);
    EXPECT_EQ(thin.u_roughness, -1);
}

TEST(GltfTransmission, RoughWithoutAVolumeIsAFrostedPane) {
    const auto pane = transmitting(0.6);
    const auto& thin = model_of<ThinDielectricMaterial>(pane, pane.shapes[0].material);
    EXPECT_NEAR(constant_value(pane, thin.u_roughness).r, 0.36f, 1e-6f);
    EXPECT_NEAR(constant_value(pane, thin.v_roughness).r, 0.36f, 1e-6f);
    EXPECT_FALSE(contains(all_warnings(pane), "KHR_materials_transmission"));
}

TEST(GltfTransmission, WithAVolumeIsABodyThatAbsorbs) {
    const auto body = transmitting(0, {{"KHR_materials_volume",
                                        {{"thicknessFactor", 1},
                                         {"attenuationDistance", 2},
                                         {"attenuationColor", {std::exp(-1), 1, 1}}}}});
    EXPECT_NO_THROW(model_of<DielectricMaterial>(body, body.shapes[0].material));
    ASSERT_EQ(body.shapes[0].inside, 0);
    expect_near(body.media[0].sigma_a, {0.5f, 0, 0}, 1e-6f);
}

}  // namespace
}  // namespace covtrace::test
