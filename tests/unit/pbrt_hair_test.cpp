/// The material "hair".
#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

TEST(SceneHair, HasAllItsParameters) {
    const auto made = material_of(
        "\"hair\" \"float beta_m\" .1 \"float beta_n\" .2 \"float alpha\" 3 \"float eta\" 1.4 "
        "\"float eumelanin\" .5 \"float pheomelanin\" .6 \"float haircoat\" .7");
    EXPECT_TRUE(made.scene.warnings.empty()) << warnings_of(made.scene);
    const auto& m = std::get<HairMaterial>(made.material.value);
    const auto number = [&](TextureId id) { return constant_value(made.scene, id).r; };
    EXPECT_EQ(number(m.beta_m), 0.1f);
    EXPECT_EQ(number(m.beta_n), 0.2f);
    EXPECT_EQ(number(m.alpha), 3);
    EXPECT_EQ(number(m.eta), 1.4f);
    EXPECT_EQ(number(m.eumelanin), 0.5f);
    EXPECT_EQ(number(m.pheomelanin), 0.6f);
    EXPECT_EQ(number(m.coat), 0.7f);
    EXPECT_EQ(m.absorption, -1);
    EXPECT_EQ(m.reflectance, -1);
    const auto plain = material_of("\"hair\"");
    EXPECT_TRUE(plain.scene.warnings.empty()) << warnings_of(plain.scene);
    EXPECT_EQ(std::get<HairMaterial>(plain.material.value).eumelanin, -1);
    EXPECT_THROW(material_of("\"hair\" \"string beta_m\" \"smooth\""), Error);
}

TEST(SceneHair, TheFirstDescriptionPigmentCounts) {
    const std::string absorption = "\"rgb sigma_a\" [ 1 2 4 ] ",
                      colour = "\"rgb color\" [ 0 1 0 ] ",
                      reflectance = "\"rgb reflectance\" [ 1 0 0 ] ",
                      pigment = "\"float eumelanin\" 8 ";
    struct Expected {
        std::string text;
        Rgb absorption, reflectance;
        size_t warnings;
    };
    const Rgb none(-1);
    for (const Expected& e :
         {Expected{pigment + colour + reflectance + absorption, {1, 2, 4}, none, 3},
          Expected{pigment + colour + reflectance, none, {1, 0, 0}, 2},
          Expected{pigment + colour, none, {0, 1, 0}, 1}, Expected{colour, none, {0, 1, 0}, 0}}) {
        const auto made = material_of("\"hair\" " + e.text);
        const auto& m = std::get<HairMaterial>(made.material.value);
        const auto value = [&](TextureId id) {
            return id < 0 ? none : constant_value(made.scene, id);
        };
        EXPECT_EQ(value(m.absorption), e.absorption) << e.text;
        EXPECT_EQ(value(m.reflectance), e.reflectance) << e.text;
        EXPECT_EQ(m.eumelanin, -1) << e.text;
        EXPECT_EQ(made.scene.warnings.size(), e.warnings) << warnings_of(made.scene);
    }
}

TEST(SceneHair, LayersThatAMaterialHasNotAreToldOnce) {
    for (const char* type : {"hair", "diffusetransmission", "coatedconductor"}) {
        const auto made = material_of("\"" + std::string(type) +
                                      "\" \"float coat\" 1 \"float coatroughness\" 0.1 "
                                      "\"rgb sheen\" [ 1 1 1 ]");
        ASSERT_EQ(made.scene.warnings.size(), 1u) << warnings_of(made.scene);
        EXPECT_NE(made.scene.warnings[0].text.find("\"coat\" and \"sheen\" are ignored"),
                  std::string::npos);
        EXPECT_FALSE(made.material.sheen || made.material.clearcoat);
    }
    EXPECT_TRUE(material_of("\"diffuse\" \"float coat\" 1").scene.warnings.empty());
}

}  // namespace
}  // namespace covtrace::test
