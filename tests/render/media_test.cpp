// Media whose image is known: transmittance, single scattering in closed form, furnaces.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

constexpr int kSize = 8;

/// Parallel rays along +z through a square of 2 x 2 units.
std::string looking_along_z(int max_depth, const std::string& camera_medium = {}) {
    return fmt::format(R"(
Integrator "volpath" "integer maxdepth" {}
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
PixelFilter "box"
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 0.02 0.05 0.1 ] "rgb sigma_s" [ 0.1 0.05 0.02 ] "float g" 0.3
LookAt 0 0 -4  0 0 0  0 1 0
MediumInterface "" "{}"
Camera "orthographic"
WorldBegin
MediumInterface "" ""
)",
                       max_depth, camera_medium);
}

/// A slab of the medium "m" from z = -1 to z = 1.
const std::string kSlab = R"(
MediumInterface "m" ""
Material "interface"
Shape "trianglemesh" "point3 P" [ -9 -9 -1  9 -9 -1  9 9 -1  -9 9 -1 ] "integer indices" [ 0 2 1 0 3 2 ]
Shape "trianglemesh" "point3 P" [ -9 -9 1  9 -9 1  9 9 1  -9 9 1 ] "integer indices" [ 0 1 2 0 2 3 ]
)";

/// The means of the three channels over the image and their standard errors.
struct ChannelMeans {
    std::array<double, 3> mean{}, error{};
};
ChannelMeans channel_means(const Image& image) {
    ChannelMeans m;
    const auto n = double(image.pixel_count());
    for (size_t i = 0; i < image.pixel_count(); ++i)
        for (int c = 0; c < 3; ++c) {
            m.mean[size_t(c)] += image.rgb(i)[c] / n;
            m.error[size_t(c)] += image.rgb(i, "variance.")[c] / (n * n);
        }
    for (double& e : m.error) e = std::sqrt(e);
    return m;
}

/// Asserts each channel within 5 standard errors (false alarm 6e-7 each) plus `model` of its value.
void expect_channels(const RenderResult& r, const std::array<double, 3>& expected,
                     double model = 2e-4) {
    const ChannelMeans m = channel_means(r.image);
    for (size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(m.mean[c], expected[c], 5 * m.error[c] + model * expected[c])
            << "channel " << c << ", standard error " << m.error[c];
    EXPECT_EQ(summarize_image(r.image).nonfinite, 0);
}

TEST(Media, ASlabAttenuatesByItsWholeExtinction) {
    // Depth 0 shows the light that comes straight through: exp(-2 (sigma_a + sigma_s)).
    const std::string text = looking_along_z(0) + R"(
MakeNamedMedium "m" "string type" "homogeneous" "rgb sigma_a" [ 0.1 0.2 0 ] "rgb sigma_s" [ 0.2 0.5 0.3 ] "float scale" 2
LightSource "infinite" "rgb L" [ 1 1 1 ])" +
                             kSlab;
    expect_channels(render_text(text, uniform(1)), {std::exp(-1.2), std::exp(-2.8), std::exp(-1.2)},
                    1e-5);
}

TEST(Media, SingleScatteringInASlab) {
    // Distant light of irradiance 3 across the light's direction, along the view or against it:
    //   from behind the camera   sigma_s p(-1) E (1 - exp(-2 sigma_t d)) / (2 sigma_t)
    //   against it               sigma_s p(1) E d exp(-sigma_t d),   d = 2
    const std::array<double, 3> a{0.1, 0.5, 0}, s{0.3, 0.2, 1};
    const double g = 0.4, irradiance = 3, d = 2;
    const auto phase = [g](double c) {
        return (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * c, 1.5));
    };
    for (const bool behind : {true, false}) {
        std::array<double, 3> expected;
        for (size_t c = 0; c < 3; ++c) {
            const double t = a[c] + s[c];
            expected[c] = s[c] * irradiance *
                          (behind ? phase(-1) * (1 - std::exp(-2 * t * d)) / (2 * t)
                                  : phase(1) * d * std::exp(-t * d));
        }
        const std::string text =
            looking_along_z(1) +
            fmt::format(R"(
MakeNamedMedium "m" "string type" "homogeneous" "rgb sigma_a" [ {} {} {} ] "rgb sigma_s" [ {} {} {} ] "float g" {}
LightSource "distant" "rgb L" [ 3 3 3 ] "point3 from" [ 0 0 {} ] "point3 to" [ 0 0 0 ])",
                        a[0], a[1], a[2], s[0], s[1], s[2], g, behind ? -1 : 1) +
            kSlab;
        SCOPED_TRACE(behind ? "from behind the camera" : "against the view");
        expect_channels(render_text(text, uniform(256, 3)), expected);
    }
}

TEST(Media, APointLightInFogAroundTheCamera) {
    // All rays run along z at x, y in [-1, 1]; the light stands at (0, 3, 2) in fog without an end:
    //   L = int sigma_s p(c) I / r^2 exp(-sigma_t (s + r)) ds
    const std::array<double, 3> a{0.02, 0.05, 0.1}, s{0.1, 0.05, 0.02};
    const double g = 0.3, intensity = 20;
    std::array<double, 3> expected{};
    constexpr int across = 16, steps = 4000;
    const double end = 90;  // a sphere far away ends the scene there; the rest is below 1e-6
    for (int i = 0; i < across; ++i)
        for (int j = 0; j < across; ++j) {
            const double x = -1 + 2 * (i + 0.5) / across, y = -1 + 2 * (j + 0.5) / across;
            for (int k = 0; k < steps; ++k) {
                const double d = end * (k + 0.5) / steps;
                const double lx = -x, ly = 3 - y, lz = 2 - (-4 + d);
                const double r = std::sqrt(lx * lx + ly * ly + lz * lz);
                // The direction changes, on the way from the light to the camera, from -l to -z.
                const double c = lz / r;
                const double p = (1 - g * g) / (4 * M_PI * std::pow(1 + g * g - 2 * g * c, 1.5));
                for (size_t n = 0; n < 3; ++n)
                    expected[n] += s[n] * p * intensity / (r * r) *
                                   std::exp(-(a[n] + s[n]) * (d + r)) * end / steps /
                                   (across * across);
            }
        }
    // The shapes are a scene that holds the camera, and one that the camera is far from.
    for (const char* shape :
         {"Shape \"sphere\" \"float radius\" 86", "Translate 0 50 0 Shape \"sphere\""}) {
        const std::string text = looking_along_z(1, "fog") + R"(
LightSource "point" "rgb I" [ 20 20 20 ] "point3 from" [ 0 3 2 ]
AttributeBegin
MediumInterface "fog" "fog"
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
)" + shape + "\nAttributeEnd";
        expect_channels(render_text(text, uniform(2048, 5)), expected, 1e-3);
    }
}

TEST(Media, ALampInFogIsSeenWithLittleNoise) {
    // Rays pass the lamp within 1.7 units. Distances by the extinction alone rarely fall where it
    // is near: the median of the pixels' standard errors, as their samples tell them, is 16 % then,
    // and 11 % as it is.
    const std::string text = looking_along_z(1, "fog") + R"(
LightSource "point" "rgb I" [ 20 20 20 ] "point3 from" [ 0.1 0.2 2 ]
AttributeBegin
MediumInterface "fog" "fog"
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "sphere" "float radius" 86
AttributeEnd
)";
    const Image image = render_text(text, uniform(256, 7)).image;
    std::vector<double> errors;
    for (size_t i = 0; i < image.pixel_count(); ++i)
        errors.push_back(std::sqrt(double(image.rgb(i, "variance.").r)) / double(image.rgb(i).r));
    std::ranges::nth_element(errors, errors.begin() + std::ptrdiff_t(errors.size() / 2));
    EXPECT_LT(errors[errors.size() / 2], 0.135);
}

/// A scene in which every point sees radiance 1 in all directions.
struct Furnace {
    const char* name;
    const char* medium;  ///< parameters of the medium
    const char* rest;
    double spp = 128;
};

const char* const kGreyWhite = R"("rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 1.5 1.5 1.5 ])";
const char* const kSkyAndBall = R"(
LightSource "infinite" "rgb L" [ 1 1 1 ]
MediumInterface "m" ""
Material "interface"
Shape "sphere")";

TEST(Media, FurnacesStayWhite) {
    const Furnace furnaces[] = {
        {"white medium", kGreyWhite, kSkyAndBall},
        {"forwards", R"("rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 4 4 4 ] "float g" 0.8)",
         kSkyAndBall},
        {"backwards, colours of their own",
         R"("rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 0.3 1 4 ] "float g" -0.5)", kSkyAndBall},
        {"absorbs what it emits",
         R"("rgb sigma_a" [ 0.2 1 2 ] "rgb sigma_s" [ 1 0.5 2 ] "rgb Le" [ 1 1 1 ])", kSkyAndBall},
        {"in glass", kGreyWhite, R"(
LightSource "infinite" "rgb L" [ 1 1 1 ]
MediumInterface "m" ""
Material "dielectric" "float eta" 1.3
Shape "sphere")"},
        {"inside a sphere of light", kGreyWhite, R"(
AttributeBegin
ReverseOrientation
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ]
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "sphere" "float radius" 8
AttributeEnd
MediumInterface "m" ""
Material "interface"
Shape "sphere")"},
        {"a white ball in it", kGreyWhite, R"(
LightSource "infinite" "rgb L" [ 1 1 1 ]
AttributeBegin
MediumInterface "m" ""
Material "interface"
Shape "sphere" "float radius" 1.5
AttributeEnd
MediumInterface "" "m"
Material "diffuse" "rgb reflectance" [ 1 1 1 ]
Shape "sphere" "float radius" 0.5)"},
    };
    for (const Furnace& f : furnaces) {
        SCOPED_TRACE(f.name);
        const std::string text =
            looking_along_z(2000) +
            fmt::format("MakeNamedMedium \"m\" \"string type\" \"homogeneous\" {}{}", f.medium,
                        f.rest);
        expect_channels(render_text(text, uniform(f.spp, 11)), {1, 1, 1}, 1e-3);
    }
}

TEST(Media, AnEndlessFogIsAFurnaceToo) {
    const std::string text = R"(
Integrator "volpath" "integer maxdepth" 1000
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 0 0 0 ] "rgb sigma_s" [ 0.1 0.2 0.4 ]
MediumInterface "" "fog"
Camera "perspective"
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
Material "diffuse" "rgb reflectance" [ 1 1 1 ]
Translate 0 0 4
Shape "sphere")";
    expect_channels(render_text(text, uniform(128, 2)), {1, 1, 1}, 1e-3);
}

TEST(Media, CovarianceTracingGoesThroughMedia) {
    const std::string text =
        looking_along_z(2000) +
        fmt::format("MakeNamedMedium \"m\" \"string type\" \"homogeneous\" {}{}",
                    R"("rgb sigma_a" [ 0.1 0.1 0.1 ] "rgb sigma_s" [ 1 1 1 ] "rgb Le" [ 1 1 1 ])",
                    kSkyAndBall);
    const RenderResult r = render_text(text, covariance_method(64, 3));
    expect_channels(r, {1, 1, 1}, 2e-3);
    // Every path is replayed with all of its light, of which each pixel has 1.
    double weight = 0;
    for (float w : r.image.find("covweight.Y")->values) weight += w / float(kSize * kSize);
    EXPECT_NEAR(weight, 1, 0.1);
}

TEST(Media, PathIntegratorsSeeNoneAsInPbrt) {
    std::string text = looking_along_z(5) + R"(
MakeNamedMedium "m" "string type" "homogeneous" "rgb sigma_a" [ 3 3 3 ]
LightSource "infinite" "rgb L" [ 1 1 1 ])" +
                       kSlab;
    text.replace(text.find("volpath"), 7, "path");
    RenderScene scene(read_pbrt_string(text, "test", "."));
    ASSERT_EQ(scene.description.warnings.size(), 1u);
    EXPECT_NE(scene.description.warnings[0].text.find("sees no media"), std::string::npos);
    Monitor monitor;
    expect_channels(render(scene, uniform(1), monitor), {1, 1, 1}, 1e-5);
}

}  // namespace
}  // namespace covtrace
