// Strands of hair in scenes: light leaves each once, whatever is inside and outside of it.
#include <gtest/gtest.h>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// The light that one dark strand takes from a white surrounding, `state` being set before it.
double taken(const std::string& state) {
    const std::string text = R"(
Integrator "volpath" "integer maxdepth" 50
Film "rgb" "integer xresolution" 24 "integer yresolution" 24
PixelFilter "box"
LookAt 0 0 -5  0 0 0  0 1 0
Camera "orthographic" "float screenwindow" [ -1.3 1.3 -1.3 1.3 ]
WorldBegin
MakeNamedMedium "clear" "string type" "homogeneous" "rgb sigma_a" [ 1e-6 1e-6 1e-6 ]
    "rgb sigma_s" [ 0 0 0 ]
LightSource "infinite" "rgb L" [ 1 1 1 ]
)" + state + R"(
Material "hair" "rgb sigma_a" [ 0.1 0.1 0.1 ]
Shape "curve" "point3 P" [ 0 -12 0  0 -4 0  0 4 0  0 12 0 ] "float width" 1
)";
    return 1 - summarize_image(render_text(text, uniform(64)).image).mean;
}

TEST(Strand, LightLeavesItOnceWhereItShinesOrStandsInAMedium) {
    const double alone = taken("");
    EXPECT_GT(alone, 0.05);
    EXPECT_NEAR(taken("MediumInterface \"\" \"clear\"") / alone, 1, 0.03);
    EXPECT_NEAR(taken("MediumInterface \"clear\" \"\"") / alone, 1, 0.03);
    EXPECT_NEAR(taken("AreaLightSource \"diffuse\" \"rgb L\" [ 0 0 0 ]") / alone, 1, 0.03);
}

}  // namespace
}  // namespace covtrace
