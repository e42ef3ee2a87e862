#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

template <typename Light>
Light light_of(const std::string& text) {
    const auto scene = read_world("LightSource " + text);
    EXPECT_EQ(scene.lights.size(), 1u);
    return std::get<Light>(scene.lights.at(0).value);
}

TEST(SceneLights, ScalesMultiplyTheColour) {
    const auto p = light_of<PointLight>(
        "\"point\" \"rgb I\" [ 1 2 3 ] \"float scale\" 2 \"point3 from\" [ 4 5 6 ]");
    expect_near(p.intensity, {2, 4, 6}, 0);
    EXPECT_EQ(p.from, (Vec3{4, 5, 6}));
    EXPECT_FALSE(p.power.has_value());
    expect_near(light_of<PointLight>("\"point\"").intensity, Rgb{1}, 0);
}

TEST(SceneLights, PowerIsOfLightWithLuminanceOneTimesColourAndScale) {
    const auto p =
        light_of<PointLight>("\"point\" \"rgb I\" [ 2 2 2 ] \"float scale\" 3 \"float power\" 10");
    ASSERT_TRUE(p.power.has_value());
    EXPECT_NEAR(*p.power, 60, 1e-4f);
    EXPECT_FALSE(light_of<PointLight>("\"point\" \"float power\" -1").power.has_value());
}

TEST(SceneLights, SpotsHaveACone) {
    const auto s = light_of<SpotLight>(
        "\"spot\" \"float coneangle\" 20 \"float conedeltaangle\" 3 \"point3 to\" [ 1 0 0 ]");
    EXPECT_EQ(s.cone_angle, 20);
    EXPECT_EQ(s.cone_delta_angle, 3);
    EXPECT_EQ(s.to, (Vec3{1, 0, 0}));
    const auto d = light_of<SpotLight>("\"spot\"");
    EXPECT_EQ(d.cone_angle, 30);
    EXPECT_EQ(d.cone_delta_angle, 5);
    EXPECT_EQ(d.to, (Vec3{0, 0, 1}));
    EXPECT_EQ(light_of<SpotLight>("\"spot\" \"float conedeltaangle\" 40").cone_delta_angle, 40);
}

TEST(SceneLights, NarrowLinesShineAndInvisibleOnesAreTold) {
    const auto scene = read_world(
        "LightSource \"point\" \"spectrum I\" [ 588 0 589 1 590 0 ]\n"
        "LightSource \"point\" \"spectrum I\" [ 589 1 ]\n"
        "LightSource \"point\" \"spectrum I\" [ 900 1 1000 1 ]\n"
        "LightSource \"point\" \"spectrum I\" [ 400 0 500 0 ]\n");
    const auto intensity = [&](size_t i) {
        return std::get<PointLight>(scene.lights.at(i).value).intensity;
    };
    expect_near(intensity(0), intensity(1), 1e-3f);
    EXPECT_NEAR(luminance(intensity(1)), 1.0095f, 1e-3f);  // 1 less its negative blue
    for (const size_t invisible : {2, 3}) EXPECT_TRUE(is_black(intensity(invisible)));
    EXPECT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(contains(warnings_of(scene), "4: the spectrum \"I\" has no visible light"));
}

TEST(SceneLights, NegativeValuesOfSpectraAreZero) {
    const auto scene = read_world("LightSource \"point\" \"spectrum I\" [ 400 -1 500 1 600 0 ]");
    EXPECT_TRUE(contains(warnings_of(scene), "2: negative values of a spectrum are set to 0"));
    const auto cut = read_world("LightSource \"point\" \"spectrum I\" [ 400 0 500 1 600 0 ]");
    expect_near(std::get<PointLight>(scene.lights[0].value).intensity,
                std::get<PointLight>(cut.lights[0].value).intensity, 0);
}

TEST(SceneLights, DistantLightsPointBackToWhereTheyComeFrom) {
    expect_near(light_of<DistantLight>("\"distant\"").direction, {0, 0, -1}, 0);
    const auto d = light_of<DistantLight>(
        "\"distant\" \"point3 from\" [ 0 9 0 ] \"point3 to\" [ 0 0 0 ] "
        "\"rgb L\" [ 1 .5 0 ] \"float illuminance\" 4");
    expect_near(d.direction, {0, 1, 0}, 0);
    expect_near(d.radiance, {4, 2, 0}, 1e-6f);
}

TEST(SceneLights, DistantLightsMayBeDiscs) {
    EXPECT_EQ(light_of<DistantLight>("\"distant\"").angle, 0);
    const auto d =
        light_of<DistantLight>("\"distant\" \"float angle\" 0.53 \"string hiddenfrom\" \"camera\"");
    EXPECT_EQ(d.angle, 0.53f);
    EXPECT_FALSE(contains(d.visible_to, RayKind::camera));
    EXPECT_TRUE(contains(d.visible_to, RayKind::glossy));
    // Without extent no ray finds it, and nothing can be hidden
    const auto scene = read_world("LightSource \"distant\" \"string hiddenfrom\" \"camera\"");
    EXPECT_TRUE(contains(warnings_of(scene), "hiddenfrom"));
}

TEST(SceneLights, AreaLightsMayHaveACone) {
    const auto cone_of = [](const std::string& parameters) {
        const auto scene =
            read_world("AreaLightSource \"diffuse\" " + parameters + "\nShape \"sphere\"");
        return scene.area_lights.at(0).cone;
    };
    EXPECT_FALSE(cone_of("").has_value());
    const auto cone = cone_of("\"float coneangle\" 40 \"float conedeltaangle\" 12");
    ASSERT_TRUE(cone.has_value());
    EXPECT_EQ(cone->angle, 40);
    EXPECT_EQ(cone->delta_angle, 12);
    EXPECT_FALSE(cone->is_grid);
    EXPECT_EQ(cone->stretch, (Vec2{1, 1}));
    EXPECT_EQ(cone_of("\"float coneangle\" 40 \"float conestretch\" [2 0.5]")->stretch,
              (Vec2{2, 0.5f}));
    const auto grid = cone_of("\"float gridangle\" 25");
    ASSERT_TRUE(grid.has_value());
    EXPECT_EQ(grid->angle, 25);
    EXPECT_TRUE(grid->is_grid);
}

TEST(SceneLights, SpheresMayHaveASoftFalloff) {
    for (const bool is_soft : {false, true}) {
        const auto scene =
            read_world(std::string("AreaLightSource \"diffuse\" \"bool softfalloff\" ") +
                       (is_soft ? "true" : "false") + "\nShape \"sphere\"");
        EXPECT_EQ(scene.area_lights.at(0).soft_falloff, is_soft);
    }
}

TEST(SceneLights, InfiniteLightsAreUniformOrAnImage) {
    const auto u = light_of<InfiniteLight>("\"infinite\" \"rgb L\" [ 1 1 2 ] \"float scale\" .5");
    expect_near(u.radiance, {0.5f, 0.5f, 1}, 0);
    EXPECT_FALSE(u.image.has_value());
    const TemporaryFolder folder;
    const auto image = folder.write("sky.exr", "");
    const auto main = folder.write(
        "main.pbrt",
        "WorldBegin Translate 1 2 3 LightSource \"infinite\" \"string filename\" \"sky.exr\" "
        "\"float scale\" 2 \"float illuminance\" 5");
    const auto scene = read_pbrt(main);
    const auto& light = std::get<InfiniteLight>(scene.lights.at(0).value);
    EXPECT_EQ(light.image, image.lexically_normal());
    EXPECT_EQ(light.radiance, Rgb{2});
    EXPECT_NEAR(light.illuminance.value(), 10, 1e-4f);
    expect_near(scene.lights[0].light_to_world.point({}), {1, 2, 3}, 0);
    EXPECT_EQ(warnings_of(scene), "");
}

TEST(SceneLights, PortalsAreRectanglesInTheWorld) {
    const auto scene = read_world(
        "Translate 1 2 3 LightSource \"infinite\" "
        "\"point3 portal\" [ 0 0 2  0 1 2  3 1 2  3 0 2 ] Shape \"sphere\"");
    const auto& light = std::get<InfiniteLight>(scene.lights.at(0).value);
    ASSERT_TRUE(light.portal.has_value());
    EXPECT_EQ((*light.portal)[2], (Vec3{3, 1, 2}));
    EXPECT_EQ(warnings_of(scene), "");
    for (const auto& [corners, message] :
         {std::pair{"0 0 2  0 1 2  3 1 2", "a portal has 3 corners; expected 4"},
          {"0 0 2  0 1 2  3 1 2  4 0 2", "a portal must be a rectangle"},
          {"0 0 2  3 1 2  0 1 2  3 0 2", "a portal must be a rectangle"},
          {"0 0 2  0 0 2  3 0 2  3 0 2", "a portal must be a rectangle"},
          {"0 0 2  0 1 2  3 1 2.1  3 0 2", "a portal must be a rectangle"}})
        EXPECT_TRUE(
            contains(world_error(std::string("LightSource \"infinite\" \"point3 portal\" [ ") +
                                 corners + " ]"),
                     message))
            << corners;
}

TEST(SceneLights, SpectraAndBlackbodiesHaveLuminanceOne) {
    for (const char* l : {"\"blackbody L\" 3000", "\"spectrum L\" \"stdillum-F2\"",
                          "\"spectrum L\" [ 400 1 500 2 700 9 ]"}) {
        const auto u = light_of<InfiniteLight>(std::string("\"infinite\" \"float scale\" 2 ") + l);
        EXPECT_NEAR(luminance(u.radiance), 2, 1e-4f) << l;
    }
    const Rgb warm = light_of<InfiniteLight>("\"infinite\" \"blackbody L\" 3000").radiance;
    EXPECT_GT(warm.r, 1.5f);
    EXPECT_LT(warm.b, 0.5f);
}

TEST(SceneLights, AreaLightsBelongToTheShapesOfTheirBlock) {
    const auto scene = read_world(
        "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [ 3 2 1 ] \"float scale\" 2 \"bool "
        "twosided\" true\n"
        "Shape \"sphere\" Shape \"disk\" AttributeEnd Shape \"sphere\"");
    ASSERT_EQ(scene.area_lights.size(), 1u);
    expect_near(scene.area_lights[0].radiance, {6, 4, 2}, 0);
    EXPECT_TRUE(scene.area_lights[0].two_sided);
    EXPECT_EQ(scene.shapes.at(0).area_light, 0);
    EXPECT_EQ(scene.shapes.at(1).area_light, 0);
    EXPECT_EQ(scene.shapes.at(2).area_light, -1);
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

TEST(SceneLights, AreaLightsWithoutAShapeAreWarnings) {
    const auto scene = read_world("AttributeBegin\nAreaLightSource \"diffuse\"\nAttributeEnd\n");
    EXPECT_EQ(warnings_of(scene), "3: the area light has no shape\n");
}

TEST(SceneLights, InterfacesDoNotEmit) {
    const auto scene =
        read_world("Material \"interface\" AreaLightSource \"diffuse\" Shape \"sphere\"");
    EXPECT_EQ(scene.shapes.at(0).area_light, -1);
    EXPECT_TRUE(contains(warnings_of(scene), "\"interface\" are ignored"));
}

TEST(SceneLights, LightsWithImages) {
    const TemporaryFolder folder;
    folder.write("x.exr", "");
    const auto scene = read_pbrt(folder.write("scene.pbrt", R"(WorldBegin
LightSource "goniometric" "string filename" "x.exr" "rgb I" [ 1 2 3 ] "float scale" 2
LightSource "projection" "string filename" "x.exr" "float fov" 40 "float power" 7
AreaLightSource "diffuse" "string filename" "x.exr" "float scale" 3
Shape "sphere"
)"));
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
    const auto& round = std::get<GoniometricLight>(scene.lights.at(0).value);
    EXPECT_EQ(round.intensity, Rgb(2, 4, 6));
    EXPECT_TRUE(round.image);
    const auto& slide = std::get<ProjectionLight>(scene.lights.at(1).value);
    EXPECT_EQ(slide.fov, 40);
    EXPECT_NEAR(slide.power.value(), 7, 1e-4f);
    const AreaLightDescription& area = scene.area_lights.at(0);
    EXPECT_EQ(area.radiance, Rgb(3));
    EXPECT_EQ(constant_as<ImageTexture>(scene, area.image).file.filename(), "x.exr");
}

TEST(SceneLights, AreaLightsShineByTextures) {
    const std::string light =
        "AreaLightSource \"diffuse\" \"rgb L\" [ 2 2 2 ] \"texture radiance\" ";
    const auto scene = read_world(
        light +
        "\"t\"\nShape \"sphere\"\nTexture \"t\" \"spectrum\" \"constant\" \"rgb value\" [ 1 0 3 ]");
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
    const AreaLightDescription& area = scene.area_lights.at(0);
    EXPECT_EQ(area.radiance, Rgb(2));
    EXPECT_EQ(constant_as<ConstantTexture>(scene, area.image).value, Rgb(1, 0, 3));
    EXPECT_TRUE(contains(world_error(light + "\"no\""), "names the spectrum texture \"no\""));
    EXPECT_TRUE(contains(world_error(light + "\"no\" \"string filename\" \"x.exr\""),
                         "both \"filename\" and \"radiance\""));
}

TEST(SceneLights, GoniometricLightsWithoutAnImageAreRound) {
    const auto scene = read_world("LightSource \"goniometric\"");
    EXPECT_FALSE(std::get<GoniometricLight>(scene.lights.at(0).value).image);
    EXPECT_TRUE(contains(warnings_of(scene), "has no image"));
}

TEST(SceneLights, ErrorsNameThePlace) {
    struct Case {
        const char* text;
        const char* message;
    };
    const Case cases[] = {
        {"LightSource \"projection\"", "test.pbrt:2:1: a projection light has no image"},
        {"LightSource \"sun\"", "test.pbrt:2:1: unknown light \"sun\"; expected one of point"},
        {"LightSource \"infinite\" \"string mapname\" \"a.exr\"", "\"mapname\" belongs to pbrt-v3"},
        {"LightSource \"infinite\" \"string filename\" \"no.exr\"",
         "test.pbrt:2:24: file \"no.exr\" not found"},
        {"LightSource \"infinite\" \"rgb L\" [1 1 1] \"string filename\" \"no.exr\"",
         "both \"L\" and \"filename\""},
        {"LightSource \"distant\" \"point3 to\" [ 0 0 0 ]", "are the same point"},
        {"LightSource \"distant\" \"float angle\" 181", "between 0 and 180"},
        {"LightSource \"distant\" \"float angle\" -1", "test.pbrt:2:23: parameter \"angle\""},
        {"AreaLightSource \"diffuse\" \"float coneangle\" 200", "between 0 and 180"},
        {"AreaLightSource \"diffuse\" \"float coneangle\" 20 \"float power\" 3",
         "both \"power\" and \"coneangle\""},
        {"AreaLightSource \"diffuse\" \"float gridangle\" 91", "between 0.001 and 90"},
        {"AreaLightSource \"diffuse\" \"float gridangle\" 0.0009", "between 0.001 and 90"},
        {"AreaLightSource \"diffuse\" \"float coneangle\" 20 \"float conestretch\" [1 0]",
         "two numbers above 0"},
        {"AreaLightSource \"diffuse\" \"float gridangle\" 20 \"float power\" 3",
         "both \"power\" and \"gridangle\""},
        {"AreaLightSource \"diffuse\" \"float gridangle\" 20 \"float coneangle\" 3",
         "both \"coneangle\" and \"gridangle\""},
        {"LightSource \"spot\" \"float coneangle\" 0", "between 0 and 180"},
        {"LightSource \"spot\" \"float conedeltaangle\" 61", "between 0 and twice coneangle"},
        {"LightSource \"point\" \"float scale\" -1", "must not be negative"},
        {"LightSource \"point\" \"spectrum I\" \"glass-BK8\"", "unknown spectrum \"glass-BK8\""},
        {"LightSource \"point\" \"spectrum I\" \"no.spd\"", "file \"no.spd\" not found"},
        {"LightSource \"point\" \"spectrum I\" [ 400 1 500 ]", "pairs of wavelength and value"},
        {"LightSource \"point\" \"spectrum I\" [ 500 1 400 1 ]", "must increase; entry 2"},
        {"LightSource \"point\" \"blackbody I\" 0", "temperature > 0"},
        {"LightSource \"point\" \"blackbody I\" [ 5000 2 1 ]", "temperature > 0"},
        {"LightSource \"point\" \"rgb I\" [ 1 1 ]", "has 2 values; expected three"},
        {"AreaLightSource \"area\"", "pbrt-v3"},
        {"AreaLightSource \"glow\"", "unknown area light \"glow\""},
    };
    for (const Case& c : cases) EXPECT_TRUE(contains(world_error(c.text), c.message)) << c.text;
}

}  // namespace
}  // namespace covtrace::test
