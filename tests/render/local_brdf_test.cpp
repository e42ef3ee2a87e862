// A rough mirror that shows a small lamp: in the middle of the highlight both descriptions of its
// BRDF agree, far from it the one at the actual directions is smoother.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// Determinant of the predicted spectrum at the middle of the image, (cycles/pixel)^4: the camera
/// looks at the origin from 45 degrees, the lamp stands `degrees` beside the mirror direction.
double spectrum(double degrees, const char* material, BrdfCovariance rule) {
    const double a = (45 + degrees) * 3.14159265358979 / 180;
    RenderOptions options = covariance_method(8, 2);
    options.cov_spp = 8;
    options.occlusion = Occlusion::none;
    options.brdf_covariance = rule;
    const std::string text = fmt::format(
        R"(Integrator "path" "integer maxdepth" 1
Film "rgb" "integer xresolution" 16 "integer yresolution" 16
LookAt -4 0 4  0 0 0  0 0 1
Camera "perspective" "float fov" 2
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 100 100 100 ]
Translate {} 0 {}
Shape "sphere" "float radius" 0.05
AttributeEnd
Material {}
Shape "disk" "float radius" 3)",
        4 * std::sin(a), 4 * std::cos(a), material);
    const Image image = render_text(text, options).image;
    const double xy = middle_mean(image, "spectrum.xy");
    return middle_mean(image, "spectrum.xx") * middle_mean(image, "spectrum.yy") - xy * xy;
}

constexpr const char* kRough =
    R"("conductor" "float roughness" 0.1 "bool remaproughness" false "rgb reflectance" [ 0.9 0.9 0.9 ])";
constexpr const char* kCoated =
    R"("coateddiffuse" "float roughness" 0.1 "bool remaproughness" false "rgb reflectance" [ 0 0 0 ])";
constexpr const char* kMatt = R"("diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ])";

TEST(LocalBrdf, AgreesWithThePeakInTheHighlightAndIsSmootherBesideIt) {
    for (const char* material : {kRough, kCoated}) {
        SCOPED_TRACE(material);
        const auto ratio = [&](double degrees) {
            return spectrum(degrees, material, BrdfCovariance::local) /
                   spectrum(degrees, material, BrdfCovariance::global);
        };
        EXPECT_NEAR(ratio(0), 1, 0.15);
        EXPECT_LT(ratio(35), 0.5);
        EXPECT_GT(ratio(35), 0.01);
    }
}

TEST(LocalBrdf, OfAMattSurfaceIsTheSame) {
    EXPECT_EQ(spectrum(10, kMatt, BrdfCovariance::local),
              spectrum(10, kMatt, BrdfCovariance::global));
}

}  // namespace
}  // namespace covtrace
