// Whole paths replayed in real renders: a textured plane seen in mirrors and through glass has the
// bandwidth that its unfolded distance gives, and a source's penumbra its closed form.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "covariance/covariance.hpp"
#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

constexpr int kSize = 32;
constexpr double kFov = 20;
double pixels_per_slope() {
    return kSize / (2 * std::tan(kFov * 3.14159265358979 / 360));
}

/// The head of a scene. `depth`: enough for the way from the sky to the camera that the test is
/// about, and little else.
std::string film(int depth) {
    return fmt::format(R"(
Integrator "path" "integer maxdepth" {}
Film "rgb" "integer xresolution" 32 "integer yresolution" 32
)",
                       depth);
}
/// Texture of checks so large that the middle of one fills the view: a constant spectrum 1/(4 pi^2
/// (e/2)^2) there, e = 50.
const char* kChecks = R"(
Texture "checks" "spectrum" "checkerboard" "float uscale" 0.01 "float vscale" 0.01 "float udelta" 0.5 "float vdelta" 0.5
    "rgb tex1" [ 0.9 0.9 0.9 ] "rgb tex2" [ 0.1 0.1 0.1 ]
)";
/// The plane: one unit of uv is one unit of length; the nearest edges are 50 units away.
const char* kPlane = R"(Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ]
    "point2 uv" [ -9 -9 9 -9 9 9 -9 9 ] "integer indices" [ 0 2 1 0 3 2 ])";

double spectrum_xx(const std::string& text) {
    RenderOptions options = covariance_method(8, 2);
    options.cov_spp = 8;
    options.occlusion = Occlusion::none;
    return middle_mean(render_text(text, options).image, "spectrum.xx");
}

double texture_variance(double distance) {
    const double per_pixel = distance / pixels_per_slope();
    return covariance::edge_variance(50.0) * per_pixel * per_pixel;
}

TEST(Replay, PlaneSeenDirectly) {
    const std::string text = film(1) + fmt::format(R"(LookAt 0 0 -4  0 0 0  0 1 0
Camera "perspective" "float fov" {}
WorldBegin
LightSource "infinite"
{}Material "diffuse" "texture reflectance" "checks"
{})",
                                                   kFov, kChecks, kPlane);
    EXPECT_NEAR(spectrum_xx(text) / texture_variance(4), 1, 0.05);
}

TEST(Replay, PlaneInAFlatMirrorIsAsFarAsItsImage) {
    // The camera looks from (0, 0, -3) towards a mirror at the origin, tilted by 45 degrees; the
    // plane stands 5 units to the side.
    const std::string text = film(2) + fmt::format(R"(LookAt 0 0 -3  0 0 0  0 1 0
Camera "perspective" "float fov" {}
WorldBegin
LightSource "infinite"
{}AttributeBegin
Material "conductor" "rgb reflectance" [ 0.99 0.99 0.99 ]
Shape "trianglemesh" "point3 P" [ -1 -1 -1  1 -1 1  1 1 1  -1 1 -1 ] "integer indices" [ 0 2 1 0 3 2 ]
AttributeEnd
Material "diffuse" "texture reflectance" "checks"
Translate 5 0 0
Rotate 90 0 1 0
{})",
                                                   kFov, kChecks, kPlane);
    EXPECT_NEAR(spectrum_xx(text) / texture_variance(8), 1, 0.05);
}

TEST(Replay, PlaneBehindASlabOfGlassIsNearer) {
    // A slab of index 1.5 and thickness 3 shortens the optical way by 3 (1 - 1/1.5).
    const std::string text = film(6) + fmt::format(R"(LookAt 0 0 -8  0 0 0  0 1 0
Camera "perspective" "float fov" {}
WorldBegin
LightSource "infinite"
{}AttributeBegin
Material "dielectric" "float eta" 1.5
Shape "trianglemesh" "point3 P" [ -9 -9 -5  9 -9 -5  9 9 -5  -9 9 -5 ] "integer indices" [ 0 2 1 0 3 2 ]
Shape "trianglemesh" "point3 P" [ -9 -9 -2  9 -9 -2  9 9 -2  -9 9 -2 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
Material "diffuse" "texture reflectance" "checks"
{})",
                                                   kFov, kChecks, kPlane);
    // The slab also shows the sky, without any detail: 2 r / (1 + r) of it, r = 0.04, beside the
    // plane's 0.9 through the rest.
    const double sky = 2 * 0.04 / 1.04, plane = 0.9 * (1 - 0.04) * (1 - 0.04);
    const double share = plane / (plane + sky);
    EXPECT_NEAR(spectrum_xx(text) / (share * texture_variance(8 - 3 * (1 - 1 / 1.5))), 1, 0.03);
}

TEST(Replay, ConvexMirrorSharpensAndConcaveBlursByItsCurvature) {
    // A convex mirror shrinks what it shows: more cycles per pixel than the flat one at the same
    // place.
    const auto scene = [](const char* mirror) {
        return film(2) + fmt::format(R"(LookAt 0 0 -4  0 0 0  0 1 0
Camera "perspective" "float fov" 5
WorldBegin
LightSource "infinite"
{}AttributeBegin
Material "conductor" "rgb reflectance" [ 0.99 0.99 0.99 ]
{}
AttributeEnd
Material "diffuse" "texture reflectance" "checks"
Translate 0 0 -6
{})",
                                     kChecks, mirror, kPlane);
    };
    const double flat = spectrum_xx(scene(R"(Shape "disk" "float radius" 3)"));
    const double convex = spectrum_xx(scene(R"(Translate 0 0 10
Shape "sphere" "float radius" 10)"));
    // The mirror equation is 1/s' = 2/R - 1/s with R = -10 (convex), s = 6: the image 2.73 behind
    // the mirror, magnified by 2.73/6; seen from 4 the plane's coordinates move (4 + 2.73)/(2.73/6)
    // per slope, against 10 for the flat one.
    const double ratio = (4 + 30.0 / 11) / (5.0 / 11) / 10;
    EXPECT_NEAR(convex / flat, ratio * ratio, 0.05 * ratio * ratio);
}

}  // namespace
}  // namespace covtrace
