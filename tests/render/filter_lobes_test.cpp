// Pixel filters with negative lobes in an image: nothing on a constant one, ringing at an edge.
#include <gtest/gtest.h>

#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

std::string view(const std::string& filter) {
    return R"(
Film "rgb" "integer xresolution" 16 "integer yresolution" 8
Camera "orthographic" "float screenwindow" [ -8 8 -4 4 ]
PixelFilter )" +
           filter + "\nWorldBegin\n";
}

const char* const kFilters[] = {
    R"("mitchell" "float xradius" 2 "float yradius" 2)",
    R"("sinc" "float xradius" 3 "float yradius" 3)",
};

TEST(FilterLobes, AreNotSeenInAUniformSky) {
    for (const char* filter : kFilters)
        for (const int spp : {1, 2, 16}) {
            const std::string text =
                view(filter) + R"(LightSource "infinite" "rgb L" [ 0.3 0.3 0.3 ])";
            const RenderResult r = render_text(text, uniform(spp));
            for (const float v : r.image.find("G")->values) EXPECT_NEAR(v, 0.3f, 1e-5f) << filter;
        }
}

/// A bright half before a black one, whose border lies between two columns: each column shows the
/// part of the filter on the bright side. Columns beside it leave [0, 1] by more than half a
/// percent. 32 columns' means at 5 standard errors, which stratified samples keep well within.
TEST(FilterLobes, RingAtAnEdge) {
    for (const char* filter : kFilters) {
        const std::string text = view(filter) + R"(
AreaLightSource "diffuse" "rgb L" [ 1 1 1 ] "bool twosided" true
Shape "bilinearmesh" "point3 P" [ 0 -99 1  99 -99 1  0 99 1  99 99 1 ])";
        const RenderResult r = render_text(text, uniform(4096));
        const RenderScene scene(read_pbrt_string(text, "test", "."));
        // The share of the filter at offsets above each whole number, by the filter's own table.
        const auto share_above = [&](float edge) {
            double sum = 0, all = 0;
            constexpr int n = 4000;
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < 64; ++j) {
                    const auto s = scene.filter.sample(
                        {(float(i) + 0.5f) / float(n), (float(j) + 0.5f) / 64.0f});
                    all += s.weight;
                    if (s.offset.x > edge) sum += s.weight;
                }
            return sum / all;
        };
        float lowest = 1, highest = 0;
        for (int x = 0; x < 16; ++x) {
            double mean = 0, variance = 0;
            for (size_t y = 0; y < 8; ++y) {
                mean += r.image.rgb(y * 16 + size_t(x)).g / 8;
                variance += r.image.rgb(y * 16 + size_t(x), "variance.").g / 64;
            }
            EXPECT_NEAR(mean, share_above(7.5f - float(x)), 5 * std::sqrt(variance) + 2e-3)
                << filter << ' ' << x;
            lowest = std::min(lowest, float(mean));
            highest = std::max(highest, float(mean));
        }
        EXPECT_LT(lowest, -0.005f);
        EXPECT_GT(highest, 1.005f);
    }
}

}  // namespace
}  // namespace covtrace
