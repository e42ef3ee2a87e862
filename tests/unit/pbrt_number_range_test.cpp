// Numbers that single precision cannot work with are refused where they stand.
#include <string>
#include <vector>

#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

struct Case {
    std::string text, message;
};

void expect_options_errors(const std::vector<Case>& cases) {
    for (const Case& c : cases) EXPECT_TRUE(contains(options_error(c.text), c.message)) << c.text;
}

TEST(SceneNumberRange, FiltersFitTheWidestImageAndTheirTable) {
    expect_options_errors({
        {R"(PixelFilter "gaussian" "float xradius" 1e6)",
         "test.pbrt:1:24: parameter \"xradius\" is out of range; expected at most 65536"},
        {R"(PixelFilter "box" "float yradius" 1e38)",
         "test.pbrt:1:19: parameter \"yradius\" is out of range"},
        {R"(PixelFilter "triangle" "float yradius" 65537)", "expected at most 65536"},
        {R"(PixelFilter "sinc" "float xradius" 1e38)", "expected at most 128"},
        {R"(PixelFilter "sinc" "float tau" 1e-3)",
         "test.pbrt:1:20: parameter \"tau\" is too small"},
        {R"(PixelFilter "mitchell" "float B" 1e10)",
         "test.pbrt:1:24: parameter \"B\" is out of range; expected at most 10 in size"},
        {R"(PixelFilter "mitchell" "float C" -1e10)", "parameter \"C\" is out of range"},
    });
    for (const char* text :
         {R"(PixelFilter "gaussian" "float xradius" 1e-6 "float yradius" 65536)",
          R"(PixelFilter "gaussian" "float sigma" 1e-30)", R"(PixelFilter "sinc" "float tau" 0.1)",
          R"(PixelFilter "mitchell" "float B" 10 "float C" -10)"})
        EXPECT_NO_THROW(read_options(text)) << text;
}

TEST(SceneNumberRange, CamerasHaveASize) {
    expect_options_errors({
        {R"(Camera "perspective" "float fov" 1e-30)",
         "test.pbrt:1:22: parameter \"fov\" is too small; expected at least 1e-6 degrees"},
        {R"(Camera "perspective" "float frameaspectratio" 1e-45)",
         "parameter \"frameaspectratio\" is out of range"},
        {R"(Camera "perspective" "float screenwindow" [-1e-45 1e-45 -1 1])",
         "parameter \"screenwindow\" is out of range"},
        {R"(Camera "orthographic" "float screenwindow" [-1 1 -1e38 1e38])",
         "parameter \"screenwindow\" is out of range"},
        {"Film \"rgb\" \"float iso\" 1e38\nCamera \"perspective\" \"float shutterclose\" 1e30",
         "test.pbrt:2:22: the film's iso times the shutter's time is too large"},
    });
}

TEST(SceneNumberRange, LightsAreNumbersOnTheFilm) {
    const std::string bright = "the light is too bright; expected a product";
    for (const char* light :
         {R"(LightSource "infinite" "rgb L" [1e20 1e20 1e20] "float scale" 1e20)",
          R"(LightSource "point" "rgb I" [1e20 1e20 1e20] "float scale" 1e20)",
          R"(LightSource "spot" "rgb I" [1e20 1e20 1e20] "float scale" 1e20)",
          R"(LightSource "distant" "rgb L" [1e20 1e20 1e20] "float scale" 1e20)",
          R"(LightSource "goniometric" "rgb I" [1e20 1e20 1e20] "float scale" 1e20)",
          R"(AreaLightSource "diffuse" "rgb L" [1e20 1e20 1e20] "float scale" 1e20)"})
        EXPECT_TRUE(contains(world_error(light), "test.pbrt:2:1: " + bright)) << light;
    for (
        const char* target :
        {R"(LightSource "infinite" "float scale" 1e10 "float illuminance" 3e38)",
         R"(LightSource "distant" "float scale" 1e10 "float illuminance" 3e38)",
         R"(LightSource "point" "float scale" 1e10 "float power" 3e38)",
         R"(AreaLightSource "diffuse" "float scale" 1e10 "float power" 3e38)",
         R"(MakeNamedMedium "m" "string type" "homogeneous" "float Lescale" 3e38 "rgb Le" [9 9 9])"})
        EXPECT_TRUE(contains(world_error(target), bright)) << target;
    const Failure film = failure_of([] {
        read_pbrt_string(
            "Film \"rgb\" \"float iso\" 1e30\nWorldBegin\n"
            "LightSource \"infinite\" \"float scale\" 1e20",
            "test.pbrt");
    });
    EXPECT_TRUE(contains(film.message, "test.pbrt:3:1: the light is too bright for the film"));
    EXPECT_NO_THROW(read_world(R"(LightSource "infinite" "rgb L" [1e38 1e38 1e38])"));
}

TEST(SceneNumberRange, IndicesOfRefraction) {
    EXPECT_TRUE(contains(world_error(R"(Material "coatedconductor" "float interface.eta" 3e38)"),
                         "test.pbrt:2:28: parameter \"interface.eta\" is too large"));
    EXPECT_TRUE(contains(world_error(R"(Material "dielectric" "float eta" 1e7)"), "too large"));
    EXPECT_NO_THROW(read_world(R"(Material "dielectric" "float eta" 1e6)"));
    for (const char* name : {"eta", "filmeta"}) {
        const std::string material =
            std::string("Material \"dielectric\" \"float filmthickness\" 300 \"float ") + name;
        EXPECT_TRUE(contains(world_error(material + "\" 1e-7"), "too small"));
        EXPECT_NO_THROW(read_world(material + "\" 1e-6"));
    }
}

TEST(SceneNumberRange, StrengthsOfBumps) {
    for (const char* strength : {"-1", "1e30"})
        EXPECT_TRUE(contains(
            world_error(std::string("Material \"diffuse\" \"float bumpstrength\" ") + strength),
            "a \"bumpstrength\" is out of range; expected a number from 0 to 1000"));
}

}  // namespace
}  // namespace covtrace::test
