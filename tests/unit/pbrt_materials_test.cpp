#include "pbrt_test_support.h"
#include "scene/dispersion.h"

namespace covtrace::test {
namespace {

TEST(SceneMaterials, TheDefaultIsDiffuseGrey) {
    const auto scene = read_world("Shape \"sphere\"");
    const auto& m = std::get<DiffuseMaterial>(
        scene.materials.at(static_cast<size_t>(scene.shapes.at(0).material)).value);
    EXPECT_EQ(constant_value(scene, m.reflectance), Rgb{0.5f});
}

TEST(SceneMaterials, CoatedDiffuseHasAllItsParameters) {
    const auto made = material_of(
        "\"coateddiffuse\" \"rgb reflectance\" [ .1 .2 .3 ] \"float roughness\" .4 \"float "
        "vroughness\" .2\n"
        "\"float thickness\" .5 \"float g\" .3 \"rgb albedo\" [ .6 .6 .6 ] \"float eta\" 1.7\n"
        "\"bool remaproughness\" false \"integer maxdepth\" 3 \"integer nsamples\" 2");
    const auto& m = std::get<CoatedDiffuseMaterial>(made.material.value);
    const auto value = [&](TextureId id) { return constant_value(made.scene, id); };
    EXPECT_EQ(value(m.reflectance), (Rgb{0.1f, 0.2f, 0.3f}));
    EXPECT_EQ(value(m.u_roughness), Rgb{0.4f});
    EXPECT_EQ(value(m.v_roughness), Rgb{0.2f});
    EXPECT_EQ(value(m.thickness), Rgb{0.5f});
    EXPECT_EQ(value(m.g), Rgb{0.3f});
    EXPECT_EQ(value(m.albedo), Rgb{0.6f});
    EXPECT_EQ(m.eta, 1.7f);
    EXPECT_FALSE(m.remap_roughness);
    EXPECT_EQ(m.max_depth, 3);
    EXPECT_EQ(m.samples, 2);
    EXPECT_TRUE(made.scene.warnings.empty()) << warnings_of(made.scene);
}

TEST(SceneMaterials, DefaultsAreThoseOfPbrt) {
    const auto made = material_of("\"coateddiffuse\"");
    const auto& m = std::get<CoatedDiffuseMaterial>(made.material.value);
    EXPECT_EQ(constant_value(made.scene, m.reflectance), Rgb{0.5f});
    EXPECT_EQ(constant_value(made.scene, m.u_roughness), Rgb{0});
    EXPECT_EQ(constant_value(made.scene, m.thickness), Rgb{0.01f});
    EXPECT_EQ(m.eta, 1.5f);
    EXPECT_TRUE(m.remap_roughness);
    EXPECT_EQ(model_of<DielectricMaterial>("\"dielectric\"").eta, 1.5f);
    const auto t = material_of("\"diffusetransmission\"");
    const auto& d = std::get<DiffuseTransmissionMaterial>(t.material.value);
    EXPECT_EQ(constant_value(t.scene, d.reflectance), Rgb{0.25f});
    EXPECT_EQ(constant_value(t.scene, d.transmittance), Rgb{0.25f});
}

TEST(SceneMaterials, GlassHasItsIndexAtEachWavelength) {
    const auto made =
        material_of("\"dielectric\" \"spectrum eta\" \"glass-BK7\" \"float roughness\" .1");
    const auto& bk7 = std::get<DielectricMaterial>(made.material.value);
    EXPECT_NEAR(bk7.eta, 1.5168f, 1e-4f);
    EXPECT_TRUE(made.scene.warnings.empty()) << warnings_of(made.scene);
    // Schott's indices of N-BK7 at the lines F' and C'.
    ASSERT_TRUE(bk7.dispersion);
    EXPECT_NEAR(bk7.eta * bk7.dispersion->at(480.0f), 1.5228f, 2e-4f);
    EXPECT_NEAR(bk7.eta * bk7.dispersion->at(643.8f), 1.5147f, 2e-4f);
    const auto pairs =
        model_of<DielectricMaterial>("\"dielectric\" \"spectrum eta\" [ 500 1.4 600 1.6 ]");
    EXPECT_NEAR(pairs.eta, 1.5752f, 1e-4f);
    EXPECT_NEAR(pairs.eta * pairs.dispersion->at(552.5f), 1.505f, 1e-4f);
    EXPECT_NEAR(pairs.eta * pairs.dispersion->at(400.0f), 1.4f, 1e-4f);
    const auto rgb = model_of<DielectricMaterial>("\"dielectric\" \"rgb eta\" [ 1.4 1.5 1.6 ]");
    ASSERT_TRUE(rgb.dispersion);
    EXPECT_GT(rgb.dispersion->at(440), rgb.dispersion->at(640));
}

TEST(SceneMaterials, EvenIndicesDoNotDisperse) {
    for (const char* eta : {"\"float eta\" 1.4", "\"rgb eta\" [ 1.4 1.4 1.4 ]",
                            "\"spectrum eta\" [ 400 1.4 700 1.4 ]"}) {
        const auto m = model_of<DielectricMaterial>(std::string("\"dielectric\" ") + eta);
        EXPECT_NEAR(m.eta, 1.4f, 1e-6f) << eta;
        EXPECT_EQ(m.dispersion, nullptr) << eta;
    }
}

TEST(SceneMaterials, CoatsAndPanesHaveTheIndexAtTheHeliumLine) {
    for (const char* type : {"coateddiffuse", "thindielectric"}) {
        const auto made =
            material_of(std::string("\"") + type + "\" \"spectrum eta\" \"glass-BK7\"");
        EXPECT_TRUE(contains(warnings_of(made.scene), "dispersion of coats and panes"));
    }
}

Rgb normal_reflectance(const Made& made) {
    const auto& m = std::get<ConductorMaterial>(made.material.value);
    const Rgb n = constant_value(made.scene, m.eta), k = constant_value(made.scene, m.k);
    Rgb f;
    for (int c = 0; c < 3; ++c) f[c] = (sqr(n[c] - 1) + sqr(k[c])) / (sqr(n[c] + 1) + sqr(k[c]));
    return f;
}

TEST(SceneMaterials, MetalsHaveTheColourOfTheirSpectra) {
    const auto metal = [](const std::string& name) {
        return normal_reflectance(material_of("\"conductor\" \"spectrum eta\" \"metal-" + name +
                                              "-eta\" \"spectrum k\" \"metal-" + name + "-k\""));
    };
    // Linear colours as tabulated for normal incidence (Hoffman, "Physics and Math of Shading",
    // SIGGRAPH 2015).
    expect_near(metal("Ag"), {0.97f, 0.96f, 0.92f}, 0.03f);
    expect_near(metal("Al"), {0.91f, 0.92f, 0.92f}, 0.02f);
    expect_near(metal("Au"), {1.0f, 0.77f, 0.34f}, 0.06f);
    expect_near(metal("Cu"), {0.96f, 0.64f, 0.54f}, 0.04f);
    expect_near(metal("TiO2"), {0.23f, 0.24f, 0.27f}, 0.03f);
}

TEST(SceneMaterials, ConductorsDefaultToCopper) {
    const Rgb copper = normal_reflectance(material_of(
        "\"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" \"metal-Cu-k\""));
    expect_near(normal_reflectance(material_of("\"conductor\"")), copper, 0);
    expect_near(normal_reflectance(material_of("\"conductor\" \"spectrum eta\" \"metal-Cu-eta\"")),
                copper, 0);
}

TEST(SceneMaterials, ConductorColoursAreKept) {
    const auto made = material_of(
        "\"conductor\" \"rgb eta\" [ .2 .9 1.1 ] \"rgb k\" [ 3.9 2.4 2.1 ] \"float uroughness\" "
        ".25");
    const auto& m = std::get<ConductorMaterial>(made.material.value);
    EXPECT_EQ(constant_value(made.scene, m.eta), (Rgb{0.2f, 0.9f, 1.1f}));
    // The reflectance is (n - 1)^2 + k^2 over (n + 1)^2 + k^2 of each channel; k may follow the
    // colour of smooth spectra.
    expect_near(normal_reflectance(made), {0.952f, 0.615f, 0.501f}, 0.05f);
    EXPECT_EQ(constant_value(made.scene, m.u_roughness), Rgb{0.25f});
    const auto mirror =
        model_of<ConductorMaterial>("\"conductor\" \"rgb reflectance\" [ .9 .9 .9 ]");
    EXPECT_GE(mirror.reflectance, 0);
    EXPECT_EQ(mirror.eta, -1);
    EXPECT_EQ(mirror.k, -1);
}

TEST(SceneMaterials, NamesMayBeUsedBeforeTheyAreDefined) {
    const auto scene = read_world(
        "NamedMaterial \"later\" Shape \"sphere\"\n"
        "MakeNamedMaterial \"later\" \"string type\" \"diffuse\" \"texture reflectance\" \"tex\"\n"
        "Texture \"tex\" \"spectrum\" \"constant\" \"rgb value\" [ .1 .2 .3 ]\n");
    const auto& m = scene.materials.at(static_cast<size_t>(scene.shapes.at(0).material));
    EXPECT_EQ(m.name, "later");
    EXPECT_EQ(constant_value(scene, std::get<DiffuseMaterial>(m.value).reflectance),
              (Rgb{0.1f, 0.2f, 0.3f}));
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

TEST(SceneMaterials, InterfacesHaveSeveralNames) {
    for (const char* name : {"interface", "", "none"})
        EXPECT_NO_THROW(model_of<InterfaceMaterial>(std::string("\"") + name + "\""));
}

TEST(SceneMaterials, OthersAreReplacedWithOneWarning) {
    const auto check = [](const std::string& text, auto expected) {
        const auto made = material_of(text);
        EXPECT_TRUE(std::holds_alternative<decltype(expected)>(made.material.value)) << text;
        EXPECT_EQ(made.scene.warnings.size(), 1u) << text << "\n" << warnings_of(made.scene);
    };
    check("\"measured\" \"string filename\" \"x.bsdf\"", CoatedDiffuseMaterial{});
}

TEST(SceneMaterials, CoatedConductors) {
    const auto made = material_of(
        "\"coatedconductor\" \"float interface.roughness\" .1 \"float conductor.uroughness\" .2 "
        "\"float conductor.roughness\" .3 \"float thickness\" 1 \"float interface.eta\" 1.3 "
        "\"spectrum conductor.eta\" \"metal-Al-eta\" \"spectrum conductor.k\" \"metal-Al-k\"");
    EXPECT_TRUE(made.scene.warnings.empty()) << warnings_of(made.scene);
    const auto& m = std::get<CoatedConductorMaterial>(made.material.value);
    const auto number = [&](TextureId id) { return constant_value(made.scene, id).r; };
    EXPECT_EQ(m.eta, 1.3f);
    EXPECT_EQ(number(m.u_roughness), 0.1f);
    EXPECT_EQ(number(m.conductor.u_roughness), 0.2f);
    EXPECT_EQ(number(m.conductor.v_roughness), 0.3f);
    EXPECT_EQ(number(m.thickness), 1);
    EXPECT_GT(constant_value(made.scene, m.conductor.k).g, 5);
}

TEST(SceneMaterials, ThinDielectrics) {
    EXPECT_EQ(model_of<ThinDielectricMaterial>("\"thindielectric\" \"float eta\" 1.4").eta, 1.4f);
}

TEST(SceneMaterials, BumpAndNormalMaps) {
    const TemporaryFolder folder;
    folder.write("n.png", "");
    const auto scene = read_pbrt(folder.write("scene.pbrt", R"(WorldBegin
Texture "bumps" "float" "checkerboard"
Material "diffuse" "texture displacement" "bumps" "float bumpstrength" 0.25
Shape "sphere"
Material "conductor" "string normalmap" "n.png" "bool mapsfollowuv" true
Shape "sphere"
Material "diffuse" "float displacement" 2
Shape "sphere"
)"));
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
    const auto of = [&](size_t shape) {
        return scene.materials.at(static_cast<size_t>(scene.shapes.at(shape).material));
    };
    EXPECT_TRUE(std::holds_alternative<CheckerboardTexture>(
        scene.textures.at(static_cast<size_t>(of(0).displacement)).value));
    EXPECT_EQ(of(0).normal_map, -1);
    EXPECT_FALSE(of(0).maps_follow_uv);
    EXPECT_EQ(of(0).bump_strength, 0.25f);
    EXPECT_EQ(of(1).bump_strength, 1);
    EXPECT_TRUE(of(1).maps_follow_uv);
    EXPECT_EQ(constant_as<ImageTexture>(scene, of(1).normal_map).encoding,
              ImageTexture::Encoding::linear);
    EXPECT_EQ(of(2).displacement, -1) << "a constant height turns no normal";
}

TEST(SceneMaterials, SubsurfaceTakesTheNameThenCoefficientsThenReflectance) {
    struct Body {
        SubsurfaceMaterial material;
        Rgb absorption, reflectance;
    };
    const auto body = [](const std::string& text) {
        const auto made = material_of("\"subsurface\" " + text);
        EXPECT_TRUE(made.scene.warnings.empty()) << warnings_of(made.scene);
        const auto& m = std::get<SubsurfaceMaterial>(made.material.value);
        EXPECT_TRUE(m.border.reflects_through_coat);
        const auto value = [&](TextureId id) {
            return id < 0 ? Rgb(-1) : constant_value(made.scene, id);
        };
        return Body{m, value(m.absorption), value(m.border.reflectance)};
    };
    const std::string ketchup =
        "\"rgb sigma_a\" [ .061 .97 1.45 ] \"rgb sigma_s\" [ .18 .07 .03 ] ";
    const std::string green = "\"rgb reflectance\" [ 0 1 0 ] \"rgb mfp\" [ 2 2 2 ] ";
    const std::string cream = "\"string name\" \"Cream\" ";
    expect_near(body(ketchup + green + "\"float scale\" 4").absorption, {.061f, .97f, 1.45f}, 0);
    EXPECT_EQ(body(ketchup + "\"float scale\" 4").material.scale, 4);
    expect_near(body("\"string name\" \"Ketchup\" \"float g\" .8").absorption, {.061f, .97f, 1.45f},
                1e-6f);
    EXPECT_LT(body(cream + ketchup + green).absorption.b, 0.1f);
    EXPECT_LT(body(ketchup + green).material.border.reflectance, 0);
    expect_near(body(green).reflectance, {0, 1, 0}, 0);
    EXPECT_LT(body(green).material.absorption, 0);
    // Without any description the body is marble, as in pbrt
    expect_near(body("").absorption, {0.0011f, 0.0024f, 0.014f}, 1e-6f);
    EXPECT_EQ(body("").material.border.eta, 1.33f);
    EXPECT_TRUE(contains(world_error("Material \"subsurface\" \"string name\" \"Ketchip\""),
                         "did you mean \"Ketchup\""));
    EXPECT_TRUE(contains(world_error("Material \"subsurface\" \"float scale\" -1"),
                         "\"scale\" of material \"subsurface\" must not be negative"));
    EXPECT_TRUE(contains(world_error("Material \"subsurface\" \"rgb sigma_a\" [ 1 1 1 ]"),
                         "expected both or none"));
}

TEST(SceneMaterials, MixesKeepBothParts) {
    const std::string two =
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n"
        "MakeNamedMaterial \"b\" \"string type\" \"conductor\"\n";
    const auto scene =
        read_world(two +
                   "Material \"mix\" \"string materials\" [ \"a\" \"b\" ] \"float amount\" .2\n"
                   "Shape \"sphere\"");
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
    const auto& m = scene.materials.at(static_cast<size_t>(scene.shapes.at(0).material));
    ASSERT_TRUE(m.mix);
    EXPECT_EQ(constant_value(scene, m.mix->amount), Rgb(0.2f));
    EXPECT_EQ(scene.materials.at(static_cast<size_t>(m.mix->materials[0])).name, "a");
    EXPECT_EQ(scene.materials.at(static_cast<size_t>(m.mix->materials[1])).name, "b");
    EXPECT_EQ(m.mix->weight, 1);
    const auto weighted = [&](const char* weight) {
        return two + "Material \"mix\" \"string materials\" [ \"a\" \"b\" ] \"float weight\" " +
               weight + "\nShape \"sphere\"";
    };
    const auto sum = read_world(weighted("2"));
    EXPECT_EQ(sum.materials.at(static_cast<size_t>(sum.shapes.at(0).material)).mix->weight, 2);
    for (const char* wrong : {"-1", "1001"})
        EXPECT_TRUE(contains(world_error(weighted(wrong)), "between 0 and 1000")) << wrong;
}

TEST(SceneMaterials, ReflectancesAreAtMostOne) {
    const auto made = material_of("\"diffuse\" \"rgb reflectance\" [ 2 .5 .5 ]");
    EXPECT_EQ(
        constant_value(made.scene, std::get<DiffuseMaterial>(made.material.value).reflectance),
        (Rgb{1, 0.5f, 0.5f}));
    EXPECT_TRUE(contains(warnings_of(made.scene), "above 1"));
}

TEST(SceneMaterials, RoughnessesAreAtLeastZero) {
    for (const char* name : {"roughness", "uroughness", "vroughness"}) {
        const auto made = material_of("\"conductor\" \"float " + std::string(name) + "\" [ -0.3 ]");
        const auto& metal = std::get<ConductorMaterial>(made.material.value);
        EXPECT_EQ(constant_value(made.scene, metal.u_roughness), Rgb(0)) << name;
        EXPECT_EQ(constant_value(made.scene, metal.v_roughness), Rgb(0)) << name;
        ASSERT_EQ(made.scene.warnings.size(), 1u) << warnings_of(made.scene);
        EXPECT_EQ(made.scene.warnings[0].text,
                  "parameter \"" + std::string(name) + "\" is below 0; cut to 0");
    }
    for (const char* value : {"0", "0.3"})
        EXPECT_EQ(warnings_of(material_of("\"conductor\" \"float roughness\" [ " +
                                          std::string(value) + " ]")
                                  .scene),
                  "");
}

TEST(SceneMaterials, RoughnessOfSmoothMaterialsIsTold) {
    for (const char* type : {"thindielectric", "diffuse"}) {
        const auto made = material_of("\"" + std::string(type) + "\" \"float roughness\" .5");
        EXPECT_TRUE(contains(warnings_of(made.scene), "\"roughness\"")) << type;
    }
    const auto both = material_of(
        "\"conductor\" \"float uroughness\" .1 \"float vroughness\" .2 \"float roughness\" .5");
    EXPECT_EQ(warnings_of(both.scene), "");
}

TEST(SceneMaterials, WhiteOfOtherColourSpacesIsNoWarning) {
    for (const char* space : {"aces2065-1", "rec2020", "dci-p3"}) {
        const std::string text = "ColorSpace \"" + std::string(space) +
                                 "\"\nMaterial \"diffuse\" \"rgb reflectance\" [ ";
        EXPECT_TRUE(read_world(text + "1 1 1 ] Shape \"sphere\"").warnings.empty()) << space;
        EXPECT_TRUE(read_world(text + "0 1 0 ] Shape \"sphere\"").warnings.empty()) << space;
        EXPECT_EQ(read_world(text + "1.1 1 1 ] Shape \"sphere\"").warnings.size(), 1u) << space;
    }
}

TEST(SceneMaterials, TheCameraStandsInItsMedium) {
    const std::string fog =
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"\nMediumInterface \"\" \"fog\"\n"
        "Camera \"perspective\"\n";
    const auto scene = read_pbrt_string(fog + "WorldBegin\n", "test.pbrt", ".");
    EXPECT_EQ(scene.camera.medium, 0);
    const auto path = read_pbrt_string(fog + "Integrator \"path\"\nWorldBegin\n", "test.pbrt", ".");
    EXPECT_EQ(path.camera.medium, -1);
    EXPECT_TRUE(contains(warnings_of(path), "4: integrator \"path\" sees no media"))
        << warnings_of(path);
}

TEST(SceneMaterials, ErrorsNameThePlace) {
    struct Case {
        const char* text;
        const char* message;
    };
    const Case cases[] = {
        {"Material \"matte\"", "test.pbrt:2:1: material \"matte\" belongs to pbrt-v3"},
        {"Material \"velvet\"", "unknown material \"velvet\"; expected one of diffuse"},
        {"NamedMaterial \"Fluor\" Shape \"sphere\" MakeNamedMaterial \"Floor\" \"string type\" "
         "\"diffuse\"",
         "test.pbrt:2:1: material \"Fluor\" is not defined; did you mean \"Floor\"?"},
        {"MakeNamedMaterial \"a\"", "has no type"},
        {"MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"a\" \"string "
         "type\" \"diffuse\"",
         "test.pbrt:3:1: material \"a\" is already defined at test.pbrt:2:1"},
        {"Material \"conductor\" \"rgb reflectance\" [1 1 1] \"rgb k\" [1 1 1]",
         "both \"reflectance\" and"},
        {"Material \"conductor\" \"rgb reflectance\" [1 1 1] \"string edge\" \"shlick\"",
         "test.pbrt:2:48: unknown edge \"shlick\"; expected one of index, schlick, none"},
        {"Material \"conductor\" \"string edge\" \"none\"",
         "test.pbrt:2:22: a conductor has an \"edge\" but no \"reflectance\"; expected both"},
        {"Material \"diffuse\" \"float coat\" 1 \"float coateta\" 0", "must be greater than 0"},
        {"Material \"dielectric\" \"float eta\" 0", "must be greater than 0"},
        {"Material \"dielectric\" \"spectrum eta\" \"stdillum-A\"", "is a light"},
        {"Material \"mix\" \"string materials\" [ \"a\" ]", "names of two materials"},
        {"Material \"mix\" \"string materials\" [ \"a\" \"b\" ]", "material \"a\" is not defined"},
        {"MakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [ \"a\" \"a\" ]",
         "mixes itself"},
        {"Material \"diffuse\" \"texture reflectance\" \"t\"",
         "names the spectrum texture \"t\", which is not defined"},
        {"Texture \"t\" \"float\" \"constant\" Material \"diffuse\" \"texture reflectance\" \"t\"",
         "the texture of this name is of type float"},
        {"MediumInterface \"fog\" \"\" Shape \"sphere\"", "medium \"fog\" is not defined"},
        {"MakeNamedMedium \"m\" \"string type\" \"gas\"", "unknown medium \"gas\""},
        {"MakeNamedMedium \"m\"", "medium \"m\" has no type"},
        {"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\"", "expected \"float density\""},
        {"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" [1 -1] "
         "\"integer ny\" 2",
         "\"density\" must not be negative"},
        {"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" 1 "
         "\"point3 p1\" [1 0 1]",
         "the box from \"p0\" to \"p1\" is flat"},
        {"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" 1 "
         "\"float temperature\" 1000 \"rgb Le\" [1 1 1]",
         "both \"Le\" and \"temperature\""},
        {"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" 1 "
         "\"integer nz\" 0",
         "\"nz\" must be greater than 0"},
        {"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" 1 "
         "\"point3 p1\" [1e-44 1 1]",
         "cells that are too small"},
        {"MakeNamedMedium \"m\" \"string type\" \"cloud\" \"point3 p0\" [-3e38 0 0] "
         "\"point3 p1\" [3e38 1 1]",
         "is too large"},
        {"MakeNamedMedium \"m\" \"string type\" \"rgbgrid\"", "expected \"rgb sigma_a\""},
        {"MakeNamedMedium \"m\" \"string type\" \"nanovdb\"", "expected \"string filename\""},
        {"MakeNamedMedium \"m\" \"string type\" \"nanovdb\" \"string filename\" \"x.nvdb\"",
         "x.nvdb"},
        {"MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 3 \"float density\" "
         "[ 1 2 ]",
         "has 2 values; expected nx * ny * nz"},
        {"MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"float g\" 1", "between -1 and 1"},
    };
    for (const Case& c : cases) EXPECT_TRUE(contains(world_error(c.text), c.message)) << c.text;
}

}  // namespace
}  // namespace covtrace::test
