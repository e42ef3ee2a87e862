// The border of a fisheye's circle, which nothing in the scene tells of.
#include <gtest/gtest.h>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

TEST(Fisheye, FiltersKeepToItsCircle) {
    constexpr int kWidth = 96, kHeight = 64;
    const std::string scene = R"(
Film "rgb" "integer xresolution" 96 "integer yresolution" 64
Camera "spherical" "string mapping" "equidistant" "float fov" 200
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
)";
    for (const Method method : {Method::covariance, Method::hybrid}) {
        RenderOptions options = uniform(16);
        options.method = method;
        const Image image = render_text(scene, options).image;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const float across = float(x) + 0.5f - kWidth / 2,
                            up = float(y) + 0.5f - kHeight / 2;
                const float beyond = std::sqrt(across * across + up * up) - kHeight / 2;
                if (std::abs(beyond) < 3) continue;  // the pixel filter reaches the rim
                const float expected = beyond < 0 ? 1 : 0;
                EXPECT_NEAR(image.rgb(size_t(y * kWidth + x)).g, expected, 2e-3f)
                    << name_of(method) << " " << x << " " << y;
            }
    }
}

}  // namespace
}  // namespace covtrace
