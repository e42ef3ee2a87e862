/// Filters of `covariance` where samples are right already (docs/decisions/0097).
#include <gtest/gtest.h>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// The scene of scenes/hard/checks-to-horizon.pbrt without its lamp: only texture, lens and shutter
/// make noise.
const std::string kChecksToHorizon = R"(
Film "rgb" "integer xresolution" 64 "integer yresolution" 36
LookAt 0 1 -4  0 .6 0  0 1 0
Camera "perspective" "float fov" 45 "float shutteropen" 0 "float shutterclose" 1
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
Texture "checks" "spectrum" "checkerboard" "float uscale" 400 "float vscale" 400
    "rgb tex1" [ .8 .8 .8 ] "rgb tex2" [ .1 .1 .1 ]
Material "diffuse" "texture reflectance" "checks"
Shape "bilinearmesh" "point3 P" [ -100 0 -100  100 0 -100  -100 0 100  100 0 100 ]
ActiveTransform EndTime
Translate .8 0 0
ActiveTransform All
Material "diffuse" "rgb reflectance" [ .7 .2 .1 ]
Translate -.4 .4 0
Shape "sphere" "float radius" .4
)";

/// Mean over pixels and channels of the squared difference, relative to the reference.
double relative_error(const Image& image, const Image& reference) {
    double sum = 0;
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const Rgb a = image.rgb(i), b = reference.rgb(i);
        for (int c = 0; c < 3; ++c)
            sum += sqr(double(a[c]) - b[c]) / (sqr(double(b[c])) + 0.01) / 3;
    }
    return sum / double(image.pixel_count());
}

TEST(FilterWorth, CovarianceIsNotWorseThanItsSamplesOnChecksToTheHorizon) {
    const Image reference = render_text(kChecksToHorizon, uniform(1024, 99)).image;
    for (const uint64_t seed : {1, 2, 3}) {
        const double plain =
            relative_error(render_text(kChecksToHorizon, uniform(16, seed)).image, reference);
        const double ours = relative_error(
            render_text(kChecksToHorizon, covariance_method(16, seed)).image, reference);
        EXPECT_LT(ours, plain) << seed;
    }
}

}  // namespace
}  // namespace covtrace
