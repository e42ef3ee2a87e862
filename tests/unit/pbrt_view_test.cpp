#include <cmath>

#include "colour/sensor_matrix.h"
#include "colour/spectrum.h"
#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

TEST(SceneView, HasTheDefaultsOfPbrt) {
    const auto scene = read_options("");
    EXPECT_EQ(scene.camera.kind, CameraDescription::Kind::perspective);
    EXPECT_EQ(scene.camera.fov, 90);
    EXPECT_EQ(scene.camera.lens_radius, 0);
    EXPECT_EQ(scene.camera.focal_distance, 1e6f);
    EXPECT_EQ(scene.camera.shutter_open, 0);
    EXPECT_EQ(scene.camera.shutter_close, 1);
    EXPECT_EQ(scene.film.width, 1280);
    EXPECT_EQ(scene.film.height, 720);
    EXPECT_EQ(scene.film.iso, 100);
    EXPECT_EQ(scene.film.max_component_value, kInfinity);
    EXPECT_EQ(scene.filter.kind, FilterDescription::Kind::gaussian);
    EXPECT_EQ(scene.filter.x_radius, 1.5f);
    EXPECT_EQ(scene.filter.sigma, 0.5f);
    EXPECT_EQ(scene.samples_per_pixel, 16);
    EXPECT_EQ(scene.max_depth, 5);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(SceneView, ReadsCameraAndFilm) {
    const auto scene = read_options(
        "Camera \"orthographic\" \"float screenwindow\" [ -2 2 -1 1 ] \"float lensradius\" .1\n"
        "  \"float focaldistance\" 4 \"float shutteropen\" .2 \"float shutterclose\" .7 \"float "
        "frameaspectratio\" 2\n"
        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 32 \"string filename\" "
        "\"a b.exr\"\n"
        "  \"float iso\" 200 \"float maxcomponentvalue\" 50 \"float diagonal\" 30 \"bool "
        "savefp16\" false\n"
        "  \"float cropwindow\" [ .5 .25 0 1 ]\n"
        "Sampler \"halton\" \"integer pixelsamples\" 3 \"integer seed\" 2\n"
        "Integrator \"volpath\" \"integer maxdepth\" 9 \"string lightsampler\" \"bvh\"\n");
    const CameraDescription& c = scene.camera;
    EXPECT_EQ(c.kind, CameraDescription::Kind::orthographic);
    EXPECT_EQ(c.screen_window, (std::array<float, 4>{-2, 2, -1, 1}));
    EXPECT_EQ(c.lens_radius, 0.1f);
    EXPECT_EQ(c.focal_distance, 4);
    EXPECT_EQ(c.shutter_open, 0.2f);
    EXPECT_EQ(c.shutter_close, 0.7f);
    EXPECT_EQ(c.frame_aspect_ratio, 2);
    EXPECT_EQ(scene.film.width, 64);
    EXPECT_EQ(scene.film.height, 32);
    EXPECT_EQ(scene.film.filename, "a b.exr");
    EXPECT_EQ(scene.film.iso, 200);
    EXPECT_EQ(scene.film.max_component_value, 50);
    EXPECT_EQ(scene.film.crop_window, (std::array<float, 4>{0.25f, 0.5f, 0, 1}));
    EXPECT_EQ(scene.samples_per_pixel, 3);
    EXPECT_EQ(scene.max_depth, 9);
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

TEST(SceneView, PixelBoundsAreCutToTheImage) {
    const auto scene = read_options("Film \"rgb\" \"integer pixelbounds\" [ 10 5000 0 20 ]");
    EXPECT_EQ(scene.film.pixel_bounds, (std::array<int, 4>{10, 1280, 0, 20}));
    EXPECT_TRUE(contains(warnings_of(scene), "reach beyond the image"));
}

TEST(SceneView, FiltersHaveTheirOwnDefaults) {
    struct Case {
        const char* name;
        FilterDescription::Kind kind;
        float radius;
    };
    for (const Case& c : {Case{"box", FilterDescription::Kind::box, 0.5f},
                          Case{"triangle", FilterDescription::Kind::triangle, 2},
                          Case{"mitchell", FilterDescription::Kind::mitchell, 2},
                          Case{"sinc", FilterDescription::Kind::lanczos_sinc, 4},
                          Case{"gaussian", FilterDescription::Kind::gaussian, 1.5f}}) {
        const auto scene = read_options(std::string("PixelFilter \"") + c.name + "\"");
        EXPECT_EQ(scene.filter.kind, c.kind);
        EXPECT_EQ(scene.filter.x_radius, c.radius);
        EXPECT_EQ(scene.filter.y_radius, c.radius);
    }
}

TEST(SceneView, SamplersSayHowManySamples) {
    const auto count = [](const std::string& text) {
        return read_options("Sampler " + text).samples_per_pixel;
    };
    EXPECT_EQ(
        count("\"stratified\" \"integer xsamples\" 3 \"integer ysamples\" 5 \"bool jitter\" false"),
        15);
    EXPECT_EQ(count("\"stratified\""), 16);
    EXPECT_EQ(count("\"independent\""), 4);
    for (const char* name : {"halton", "sobol", "zsobol", "paddedsobol", "pmj02bn"})
        EXPECT_EQ(count(std::string("\"") + name + "\" \"integer pixelsamples\" 7"), 7);
}

TEST(SceneView, WhatIsNotRenderedIsReplacedWithAWarning) {
    for (const char* text :
         {"Integrator \"bdpt\" \"bool visualizestrategies\" true", "Integrator \"sppm\"",
          "Film \"spectral\"", "Camera \"realistic\" \"string lensfile\" \"x.dat\"",
          "ColorSpace \"rec2020\" Film \"rgb\"", "Film \"rgb\" \"float scale\" 2"}) {
        const auto scene = read_options(text);
        EXPECT_EQ(scene.warnings.size(), 1u) << text << "\n" << warnings_of(scene);
    }
}

TEST(SceneView, IntegratorsRegularizeWhereAsked) {
    EXPECT_FALSE(read_options("Integrator \"path\"").regularizes);
    const auto scene = read_options("Integrator \"volpath\" \"bool regularize\" true");
    EXPECT_TRUE(scene.regularizes);
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

TEST(SceneView, GBuffersKeepTheFirstSurfaces) {
    using Surfaces = FilmDescription::Surfaces;
    EXPECT_EQ(read_options("Film \"rgb\"").film.surfaces, Surfaces::none);
    const auto scene = read_options("Film \"gbuffer\"");
    EXPECT_EQ(scene.film.surfaces, Surfaces::camera);
    EXPECT_EQ(warnings_of(scene), "");
    const char* world = "Film \"gbuffer\" \"string coordinatesystem\" \"world\"";
    EXPECT_EQ(read_options(world).film.surfaces, Surfaces::world);
}

TEST(SceneView, NamedSensorsReplaceTheWhiteBalance) {
    const auto scene = read_options("Film \"rgb\" \"string sensor\" \"nikon_d850\"");
    EXPECT_EQ(warnings_of(scene), "");
    EXPECT_EQ(scene.film.sensor, sensor_matrices(*find_sensor("nikon_d850"), 6500).shown);
    const auto warm =
        read_options("Film \"rgb\" \"string sensor\" \"nikon_d850\" \"float whitebalance\" 3200");
    EXPECT_EQ(warm.film.sensor, sensor_matrices(*find_sensor("nikon_d850"), 3200).shown);
}

TEST(SceneView, SphericalCameras) {
    using Mapping = CameraDescription::Mapping;
    EXPECT_EQ(read_options("Camera \"spherical\"").camera.mapping, Mapping::equal_area);
    const auto scene = read_options("Camera \"spherical\" \"string mapping\" \"equirectangular\"");
    EXPECT_EQ(scene.camera.kind, CameraDescription::Kind::spherical);
    EXPECT_EQ(scene.camera.mapping, Mapping::equirectangular);
    EXPECT_TRUE(contains(options_error("Camera \"spherical\" \"string mapping\" \"flat\""),
                         "expected one of equalarea, equirectangular, equidistant, equisolid"));
    const auto part = read_options(
        "Camera \"spherical\" \"string mapping\" \"equirectangular\" "
        "\"float longitude\" [ 90 270 ] \"float latitude\" [ -45 90 ]");
    EXPECT_EQ(part.camera.sphere_part, (std::array{0.25f, 0.75f, 0.0f, 0.75f}));
    const auto fisheye = read_options(
        "Camera \"spherical\" \"string mapping\" \"equisolid\" \"float fov\" 220 "
        "\"float screenwindow\" [ -2 2 -1 1 ]");
    EXPECT_EQ(fisheye.camera.mapping, Mapping::equisolid);
    EXPECT_EQ(fisheye.camera.fov, 220);
    EXPECT_TRUE(fisheye.camera.screen_window.has_value());
}

TEST(SceneView, ThinLensesMayHaveBlades) {
    const auto scene = read_options(
        "Camera \"perspective\" \"float lensradius\" 1 \"integer apertureblades\" 6 "
        "\"float aperturerotation\" 90 \"float apertureratio\" 2");
    EXPECT_EQ(scene.camera.blades.count, 6);
    EXPECT_NEAR(scene.camera.blades.rotation, kPi / 2, 1e-6f);
    EXPECT_EQ(scene.camera.blades.ratio, 2);
    EXPECT_EQ(read_options("Camera \"perspective\"").camera.blades.count, 0);
}

constexpr const char* kTwoLenses = R"(# radius thickness index diameter
100 0.001 1.5 30
-100 0.001 1 30
0 0.001 0 12   # the stop
100 0.001 1.5 30
-100 40 1 30
)";

TEST(SceneView, LensesAreReadWithTheThinOneThatStandsForThem) {
    const TemporaryFolder folder;
    // The lens is two thin lenses of 100 mm in contact.
    folder.write("two.dat", kTwoLenses);
    const auto scene = read_pbrt(folder.write("scene.pbrt", R"(
Camera "realistic" "string lensfile" "two.dat" "float aperturediameter" 10 "float focusdistance" 5.1005
Film "rgb" "integer xresolution" 30 "integer yresolution" 40 "float diagonal" 50
WorldBegin
)"));
    EXPECT_TRUE(scene.warnings.size() <= 1) << warnings_of(scene);  // it has no lights
    const CameraDescription& camera = scene.camera;
    ASSERT_TRUE(camera.lens);
    ASSERT_EQ(camera.lens->surfaces.size(), 5u);
    EXPECT_NEAR(camera.lens->surfaces[1].curvature_radius, -0.1f, 1e-7f);
    EXPECT_NEAR(camera.lens->surfaces[0].thickness, 1e-6f, 1e-10f);
    EXPECT_EQ(camera.lens->surfaces[2].index, 1) << "0 is air";
    EXPECT_NEAR(camera.lens->surfaces[4].aperture_radius, 15e-3f, 1e-7f);
    EXPECT_NEAR(camera.lens->film_diagonal, 50e-3f, 1e-7f);
    // The stop stands behind one of both lenses, so its image before it is hardly larger.
    EXPECT_NEAR(camera.lens_radius, 5e-3f, 1e-6f);
    EXPECT_NEAR(camera.film_irradiance, kPi * sqr(5e-3f / 50.5e-3f), 1e-4f);
    EXPECT_NEAR(camera.focal_distance, 5.1005f, 1e-6f);
    // The lens has 50 mm and is focused at 5.1005 m from the film, 5.05 m from the lens: 50.5 mm
    // behind the lens; the shorter side is 30 mm.
    EXPECT_NEAR(camera.fov, 2 * std::atan(15 / 50.5f) * 180 / kPi, 0.01f);
}

TEST(SceneView, LensesTellWhatTheyCannotDo) {
    const TemporaryFolder folder;
    folder.write("two.dat", kTwoLenses);
    const auto read = [&](const std::string& parameters) {
        return read_pbrt(
            folder.write("scene.pbrt", "Camera \"realistic\" \"string lensfile\" \"two.dat\" " +
                                           parameters + "\nWorldBegin\nLightSource \"infinite\""));
    };
    const auto error = [&](const std::string& parameters) {
        return failure_of([&] { read(parameters); }).message;
    };
    const auto wide = read("\"float aperturediameter\" 40");
    EXPECT_TRUE(contains(warnings_of(wide), "opens to 12 mm only"));
    EXPECT_NEAR(wide.camera.lens_radius, 6e-3f, 1e-6f);
    using Kind = ApertureShape::Kind;
    for (const auto& [name, kind] :
         {std::pair("circular", Kind::round), std::pair("gaussian", Kind::gaussian),
          std::pair("square", Kind::square), std::pair("pentagon", Kind::pentagon),
          std::pair("star", Kind::star)})
        EXPECT_EQ(
            read("\"string aperture\" \"" + std::string(name) + "\"").camera.lens->aperture.kind,
            kind);
    EXPECT_TRUE(contains(error("\"string aperture\" \"blades.png\""), "blades.png"));
    folder.write("blades.png", "");
    EXPECT_EQ(read("\"string aperture\" \"blades.png\"").camera.lens->aperture.image.filename(),
              "blades.png");
    EXPECT_TRUE(contains(error("\"float focusdistance\" 0.19"), "expected more than 0.2"));
    const auto with_lens = [&](const char* text) {
        folder.write("two.dat", text);
        return error("");
    };
    EXPECT_TRUE(contains(with_lens("1 2 3"), "expected four for each element"));
    EXPECT_TRUE(contains(with_lens("100 1 x 4"), "something else than numbers"));
    EXPECT_TRUE(contains(with_lens("-100 1 1.5 4\n100 1 1 4"), "does not focus light"));
    EXPECT_TRUE(contains(with_lens("100 1 1.5 0\n-100 1 1 4"), "element 1 has no diameter"));
    EXPECT_TRUE(contains(with_lens("100 1 -1.5 3\n-100 1 1 4"), "negative index"));
}

TEST(SceneView, WhiteBalanceMakesDaylightWhite) {
    const auto scene = read_options("Film \"rgb\" \"float whitebalance\" 6504");
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) EXPECT_NEAR(scene.film.sensor[i][j], i == j ? 1 : 0, 2e-3f);
    // The light is a candle's, and the image is balanced for it.
    const FilmDescription film = read_options("Film \"rgb\" \"float whitebalance\" 2800").film;
    const auto& warm = film.sensor;
    const Rgb candle = emission_colour(blackbody_spectrum(2800));
    for (const auto& row : warm)
        EXPECT_NEAR(row[0] * candle.r + row[1] * candle.g + row[2] * candle.b, 1, 5e-3f);
    // A limit is that of XYZ before the balance: of the candle's, whose Y is 1.
    const auto& y = film.sensor_values[1];
    EXPECT_NEAR(y[0] + y[1] + y[2], 1, 5e-3f);
}

TEST(SceneView, WindowsOfOtherThanFourValuesAreIgnoredAsInPbrt) {
    const auto scene = read_options("Camera \"orthographic\" \"float screenwindow\" [ -.1 .1 ]\n");
    EXPECT_EQ(scene.camera.screen_window, std::nullopt);
    EXPECT_NE(warnings_of(scene).find("1: parameter \"screenwindow\" has 2 values"),
              std::string::npos)
        << warnings_of(scene);
}

TEST(SceneView, ErrorsNameThePlace) {
    struct Case {
        const char* text;
        const char* message;
    };
    const Case cases[] = {
        {"Camera \"perspective\" \"float shutteropen\" 1",
         "test.pbrt:1:22: the shutter never opens"},
        {"Camera \"perspective\" \"float fov\" 180",
         "test.pbrt:1:22: parameter \"fov\" must be between"},
        {"Camera \"perspective\" \"float focaldistance\" 0", "must be greater than 0"},
        {"Camera \"perspective\" \"float lensradius\" -1", "must not be negative"},
        {"Camera \"perspective\" \"float screenwindow\" [ 1 2 3 3 ]", "expects x0 < x1"},
        {"Camera \"perspective\" \"integer apertureblades\" 2", "expects 0 or 3 to 1000 blades"},
        {"Camera \"perspective\" \"float apertureratio\" 0", "must be greater than 0"},
        {"Camera \"perspective\" \"float aperturerotation\" 1e30", "out of range"},
        {"Camera \"spherical\" \"string mapping\" \"equidistant\" \"float fov\" 400",
         "between 0.001 and 360 degrees"},
        {"Camera \"spherical\" \"string mapping\" \"equirectangular\" \"float latitude\" [ 9 9 ]",
         "expects two angles between -90 and 90 degrees, the lower one first"},
        {"Camera \"pinhole\"", "pbrt-v3"},
        {"Camera \"fisheye\"",
         "test.pbrt:1:1: unknown camera \"fisheye\"; expected one of perspective"},
        {"Film \"image\"", "test.pbrt:1:1: film \"image\" belongs to pbrt-v3"},
        {"Film \"rgb\" \"integer xresolution\" 0",
         "test.pbrt:1:12: the resolution 0x720 has no pixels"},
        {"Film \"rgb\" \"integer yresolution\" -5", "has no pixels"},
        {"Film \"rgb\" \"float cropwindow\" [ .5 .5 0 1 ]", "leaves no pixel"},
        {"Film \"rgb\" \"integer pixelbounds\" [ 2000 3000 0 5 ]", "leaves no pixel"},
        {"Film \"rgb\" \"float iso\" 0", "must be greater than 0"},
        {"Film \"rgb\" \"string sensor\" \"nikon_d850x\"",
         "test.pbrt:1:12: unknown sensor \"nikon_d850x\""},
        {"Film \"gbuffer\" \"string coordinatesystem\" \"object\"",
         "test.pbrt:1:16: unknown coordinate system of a gbuffer film \"object\""},
        {"PixelFilter \"cubic\"", "unknown filter \"cubic\""},
        {"PixelFilter \"box\" \"float xradius\" 0", "must be greater than 0"},
        {"Sampler \"random\"", "pbrt-v3"},
        {"Sampler \"sobal\"", "did you mean \"sobol\""},
        {"Sampler \"sobol\" \"integer pixelsamples\" 0", "expected from 1 to 2^30"},
        {"Integrator \"path\" \"integer maxdepth\" -1", "must not be negative"},
        {"Integrator \"directlighting\"", "pbrt --upgrade"},
        {"Integrator \"magic\"", "unknown integrator \"magic\""},
        {"TransformTimes 1 1", "test.pbrt:1:1: TransformTimes expects a start before the end"},
        {"ColorSpace \"rgb\"", "unknown colour space \"rgb\""},
    };
    for (const Case& c : cases) EXPECT_TRUE(contains(options_error(c.text), c.message)) << c.text;
}

TEST(SceneView, HugeImagesAreALimit) {
    for (const char* text :
         {"\"integer xresolution\" 65537 \"integer yresolution\" 1",
          "\"integer xresolution\" 65536 \"integer yresolution\" 65536",
          "\"integer xresolution\" 2147483647 \"integer yresolution\" 2147483647"}) {
        const Failure f = failure_of([&] { read_options(std::string("Film \"rgb\" ") + text); });
        EXPECT_EQ(f.kind, ErrorKind::limit) << text;
        EXPECT_TRUE(contains(f.message, "test.pbrt:1:12: the resolution"));
    }
}

}  // namespace
}  // namespace covtrace::test
