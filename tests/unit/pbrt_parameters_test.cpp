#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

float radius_of(const std::string& parameters) {
    const auto scene = read_world("Shape \"sphere\" " + parameters);
    return std::get<Sphere>(scene.shapes.at(0).geometry).radius;
}

TEST(SceneParameters, TakesValuesWithAndWithoutBrackets) {
    EXPECT_EQ(radius_of("\"float radius\" 2"), 2);
    EXPECT_EQ(radius_of("\"float radius\" [ 2 ]"), 2);
    EXPECT_EQ(radius_of("\"float radius\" [2]"), 2);
    EXPECT_EQ(radius_of("\"float radius\" # comment\n [ # comment ]\n 2 ]"), 2);
}

TEST(SceneParameters, TakesBlanksInDeclarations) {
    EXPECT_EQ(radius_of("\" float radius\" 3"), 3);
    EXPECT_EQ(radius_of("\"float   radius \" 3"), 3);
    EXPECT_EQ(radius_of("\"\\tfloat\\tradius\" 3"), 3);
}

TEST(SceneParameters, TakesFlagsQuotedOrNot) {
    for (const char* value : {"true", "\"true\"", "[ true ]", "[ \"true\" ]"}) {
        const auto scene =
            read_world(std::string("AreaLightSource \"diffuse\" \"bool twosided\" ") + value +
                       " Shape \"sphere\"");
        EXPECT_TRUE(scene.area_lights.at(0).two_sided) << value;
    }
    const auto scene =
        read_world("AreaLightSource \"diffuse\" \"bool twosided\" false Shape \"sphere\"");
    EXPECT_FALSE(scene.area_lights.at(0).two_sided);
}

TEST(SceneParameters, TheLastOfSeveralCountsWithAWarning) {
    const auto scene = read_world("Shape \"sphere\" \"float radius\" 2 \"float radius\" 3");
    EXPECT_EQ(std::get<Sphere>(scene.shapes[0].geometry).radius, 3);
    EXPECT_TRUE(
        contains(warnings_of(scene), "2: parameter \"radius\" of shape \"sphere\" is given twice"));
}

TEST(SceneParameters, UnknownOnesAreWarnings) {
    const auto scene = read_world(
        "Shape \"sphere\" \"integer nsamples\" 4\nShape \"sphere\" \"integer nsamples\" 4");
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(
        scene.warnings[0].text,
        "parameter \"nsamples\" is not known to shape \"sphere\"; ignored (and in 1 more place)");
    EXPECT_EQ(scene.warnings[0].where.to_string(), "test.pbrt:2:16");
}

TEST(SceneParameters, AttributesAreDefaultsForOneTarget) {
    const auto scene = read_world(
        "AttributeBegin\n"
        "Attribute \"shape\" \"float radius\" 5 \"integer unknown\" 1\n"
        "Shape \"sphere\"\n"
        "Shape \"sphere\" \"float radius\" 6\n"
        "Shape \"disk\"\n"
        "AttributeEnd\n"
        "Shape \"sphere\"\n");
    EXPECT_EQ(std::get<Sphere>(scene.shapes.at(0).geometry).radius, 5);
    EXPECT_EQ(std::get<Sphere>(scene.shapes.at(1).geometry).radius, 6);
    EXPECT_EQ(std::get<Disk>(scene.shapes.at(2).geometry).radius, 5);
    EXPECT_EQ(std::get<Sphere>(scene.shapes.at(3).geometry).radius, 1);
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

TEST(SceneParameters, InheritedOnesOfAnotherTypeArePassedOver) {
    const auto scene = read_world(
        "Attribute \"shape\" \"float radius\" 5\n"
        "Attribute \"shape\" \"integer radius\" 7\n"
        "Shape \"sphere\"\n"
        "Attribute \"material\" \"float eta\" 1.4\n"
        "Material \"conductor\"\n"
        "Shape \"sphere\"\n");
    EXPECT_EQ(std::get<Sphere>(scene.shapes.at(0).geometry).radius, 5);
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
    EXPECT_TRUE(contains(world_error("Attribute \"shape\" \"float radius\" 5\n"
                                     "Shape \"sphere\" \"integer radius\" 7"),
                         "has the type integer; expected float"));
}

TEST(SceneParameters, NamesOfColourSpacesAreInCapitalsOrNot) {
    for (const char* name : {"sRGB", "srgb", "DCI-P3", "Rec2020", "ACES2065-1"})
        EXPECT_TRUE(read_world("ColorSpace \"" + std::string(name) + "\"").warnings.empty());
}

TEST(SceneParameters, ErrorsNameThePlace) {
    struct Case {
        const char* text;
        const char* message;
    };
    const Case cases[] = {
        {"\"integer radius\" 2",
         "test.pbrt:2:16: parameter \"radius\" has the type integer; expected float"},
        {"\"float radius\" [ 1 2 ]",
         "test.pbrt:2:16: parameter \"radius\" has 2 values; expected one"},
        {"\"float radius\" [ ]", "test.pbrt:2:16: parameter \"radius\" has no value"},
        {"\"float radius\"", "test.pbrt:3:1: parameter \"radius\" has no value"},
        {"\"float radius\" [ 1 ", "have no closing bracket"},
        {"\"float radius\" ]", "test.pbrt:2:31: parameter \"radius\" has no value"},
        {"\"float radius\" \"2\"",
         "test.pbrt:2:31: value \"2\" of parameter \"radius\"; expected a number"},
        {"\"float radius\" nan", "test.pbrt:2:31: \"nan\" is not a finite number"},
        {"\"float radius\" 1e99", "test.pbrt:2:31: the number \"1e99\" is too large"},
        {"\"float radius\" x", "test.pbrt:2:31: expected a number, found \"x\""},
        {"\"radius\" 2", "test.pbrt:2:16: parameter declaration \"radius\" is incomplete"},
        {"\"\" 2", "test.pbrt:2:16: parameter declaration \"\" is incomplete"},
        {"\"flaot radius\" 2", "test.pbrt:2:16: unknown parameter type \"flaot\""},
        {"\"bool x\" 1", "test.pbrt:2:25: value \"1\" of parameter \"x\"; expected true or false"},
        {"\"integer x\" 1.5", "test.pbrt:2:28: expected an integer, found \"1.5\""},
        {"\"string x\" 1", "expected a quoted string"},
        {"\"color x\" [1 1 1]", "the parameter type \"color\" belongs to pbrt-v3"},
        {"\"float alpha\" [ 1 2 ]", "expects one value"},
    };
    for (const Case& c : cases)
        EXPECT_TRUE(
            contains(world_error(std::string("Shape \"sphere\" ") + c.text + "\n"), c.message))
            << c.text;
}

TEST(SceneParameters, ColoursOfOtherSpacesBecomeRec709) {
    const auto scene = read_world(
        "ColorSpace \"rec2020\"\nMaterial \"diffuse\" \"rgb reflectance\" [ .2 .2 .2 ] Shape "
        "\"sphere\"\n"
        "ColorSpace \"srgb\"\nMaterial \"diffuse\" \"rgb reflectance\" [ .1 .2 .3 ] Shape "
        "\"sphere\"\n"
        "ColorSpace \"rec2020\"\nMaterial \"diffuse\" \"rgb reflectance\" [ 0 .5 0 ] Shape "
        "\"sphere\"\n");
    const auto reflectance = [&](size_t shape) {
        const auto& m = scene.materials[static_cast<size_t>(scene.shapes.at(shape).material)].value;
        return constant_value(scene, std::get<DiffuseMaterial>(m).reflectance);
    };
    expect_near(reflectance(0), Rgb{0.2f}, 1e-6f);
    expect_near(reflectance(1), {0.1f, 0.2f, 0.3f}, 0);
    // Colours outside of the gamut are cut to zero.
    expect_near(reflectance(2), {0, 0.56645f, 0}, 1e-4f);
}

TEST(SceneParameters, NegativeColoursAreRefused) {
    EXPECT_TRUE(contains(world_error("Material \"diffuse\" \"rgb reflectance\" [ 1 -1 1 ]"),
                         "test.pbrt:2:20: parameter \"reflectance\" has a negative component"));
}

}  // namespace
}  // namespace covtrace::test
