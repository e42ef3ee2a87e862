// Determinism: the same command gives the same bits for any number of threads; seeds give other
// bits.
#include <gtest/gtest.h>

#include <cstring>

#include "core/parallel.h"
#include "render/overrides.h"
#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

const std::string kScene = R"(
Film "rgb" "integer xresolution" 70 "integer yresolution" 50
LookAt 0 1 -6  0 0.5 0  0 1 0
Camera "perspective" "float fov" 40 "float lensradius" 0.1 "float focaldistance" 5
WorldBegin
LightSource "infinite" "rgb L" [ 0.2 0.25 0.3 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 8 8 8 ]
Translate 0 4 0
Shape "disk" "float radius" 1
AttributeEnd
Texture "checks" "spectrum" "checkerboard" "float uscale" 8 "float vscale" 8 "rgb tex1" [ 0.1 0.1 0.1 ] "rgb tex2" [ 0.8 0.8 0.8 ]
Material "diffuse" "texture reflectance" "checks"
Shape "trianglemesh" "point3 P" [ -5 0 -5  5 0 -5  5 0 5  -5 0 5 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ] "integer indices" [ 0 2 1 0 3 2 ]
AttributeBegin
ActiveTransform EndTime
Translate 1 0 0
ActiveTransform All
Translate -1 1 0
Material "conductor" "float roughness" 0.1
Shape "sphere"
AttributeEnd
AttributeBegin
Translate 1.5 1 1
Material "coateddiffuse" "rgb reflectance" [ 0.5 0.1 0.1 ] "float roughness" 0.05
Shape "sphere"
AttributeEnd
)";

bool same_bits(const Image& a, const Image& b) {
    if (a.channels.size() != b.channels.size()) return false;
    for (size_t c = 0; c < a.channels.size(); ++c)
        if (std::memcmp(a.channels[c].values.data(), b.channels[c].values.data(),
                        a.channels[c].values.size() * 4) != 0)
            return false;
    return true;
}

class Determinism : public testing::TestWithParam<Method> {};

TEST_P(Determinism, ThreadsDoNotMatter) {
    RenderOptions options = covariance_method(6, 3);
    options.method = GetParam();
    const auto with_threads = [&](int n) {
        const ThreadLimit limit(n);
        return render_text(kScene, options).image;
    };
    const Image one = with_threads(1);
    EXPECT_EQ(summarize_image(one).nonfinite, 0);
    EXPECT_TRUE(same_bits(one, with_threads(2)));
    EXPECT_TRUE(same_bits(one, with_threads(3)));
    options.seed = 4;
    EXPECT_FALSE(same_bits(one, with_threads(1)));
}

INSTANTIATE_TEST_SUITE_P(Methods, Determinism,
                         testing::Values(Method::uniform, Method::covariance, Method::hybrid));

TEST(Budget, TheAverageIsExact) {
    for (double spp : {0.5, 3.0, 6.25, 16.0}) {
        const RenderResult r = render_text(kScene, covariance_method(spp));
        EXPECT_NEAR(r.statistics.samples_per_pixel, spp, 1e-3);
        EXPECT_EQ(r.statistics.covariance.samples + r.statistics.radiance.samples,
                  uint64_t(std::llround(spp * 3500)));
    }
    EXPECT_EQ(render_text(kScene, uniform(5)).statistics.radiance.samples, 5u * 3500u);
}

TEST(Budget, MostSamplesAreRespected) {
    RenderOptions options = covariance_method(12);
    options.max_spp = 14;
    const RenderResult r = render_text(kScene, options);
    for (float n : r.image.find("samples.Y")->values) EXPECT_LE(n, 14);
}

TEST(Crop, IsTheSamePixelsOfTheFullFrame) {
    SceneDescription description = read_pbrt_string(kScene, "test", ".");
    SceneOverrides overrides;
    overrides.crop = PixelBounds{20, 10, 50, 30};
    apply(overrides, description);
    RenderScene scene(std::move(description));
    Monitor monitor;
    const Image part = render(scene, uniform(3), monitor).image,
                full = render_text(kScene, uniform(3)).image;
    EXPECT_EQ(part.data, (PixelBounds{20, 10, 50, 30}));
    EXPECT_EQ(part.display, full.display);
    for (int y = 10; y < 30; ++y)
        for (int x = 20; x < 50; ++x)
            ASSERT_EQ(part.rgb(size_t(y - 10) * 30 + size_t(x - 20)),
                      full.rgb(size_t(y) * 70 + size_t(x)));
}

}  // namespace
}  // namespace covtrace
