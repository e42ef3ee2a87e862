// Images looked up by the footprint of a pixel: mip levels, ellipses, and the footprint itself.
#include <gtest/gtest.h>

#include "core/rng.h"
#include "texture/image.h"
#include "texture/mapping.h"
#include "texture/texture.h"
#include "texture_fixtures.h"

namespace covtrace {
namespace {

using Filter = TextureImage::Filter;
using Wrap = TextureImage::Wrap;

constexpr Filter kFilters[] = {Filter::point, Filter::bilinear, Filter::trilinear, Filter::ewa};

template <typename F>
TextureImage image_of(int width, int height, F value, bool is_8bit = false,
                      TextureImage::Wraps wraps = Wrap::repeat) {
    RasterImage r;
    r.width = width;
    r.height = height;
    r.channels = 1;
    r.is_8bit = is_8bit;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) add_value(r, value(x, y));
    TextureImage image(r, TextureImage::Encoding::linear, 1, wraps);
    image.build_levels();
    return image;
}

TextureImage noise(int width, int height) {
    Rng rng(5);
    return image_of(width, height, [&](int, int) { return rng.next_float() < 0.5f ? 0.2f : 0.8f; });
}

ImageFootprint round_footprint(float radius) {
    return {{radius, 0}, {0, radius}};
}

TEST(TextureFilter, LevelsGoDownToOneTexelAndCostAThird) {
    const TextureImage image = noise(64, 16);
    EXPECT_EQ(image.level_count(), 7u);
    EXPECT_EQ(image.memory(), sizeof(float) * (64 * 16 + 32 * 8 + 16 * 4 + 8 * 2 + 4 + 2 + 1));
}

TEST(TextureFilter, APointReadsTheFinestLevelAsItIs) {
    const TextureImage image = noise(33, 17);
    Rng rng(1);
    for (int i = 0; i < 1000; ++i) {
        const Vec2 st = rng.next_2d() * 3 - Vec2{1, 1};
        const float bilinear = image.value(image.bilinear(st));
        // Footprints below half a texel are not filtered either.
        for (const float radius : {0.0f, 1e-4f, 0.2f / 33})
            for (const Filter f : {Filter::bilinear, Filter::trilinear, Filter::ewa})
                ASSERT_EQ(image.value(st, f, round_footprint(radius), 8), bilinear);
        ASSERT_EQ(image.value(st, Filter::point, {}, 8), image.value(image.nearest(st)));
    }
}

TEST(TextureFilter, AnEllipseWrapsEachAxisInItsOwnWay) {
    // Beyond the border that is clamped lies the last texel alone, beyond the other one the image.
    const auto last = [](int i) { return i < 32 ? 0.2f : 0.8f; };
    const auto across =
        image_of(64, 64, [&](int x, int) { return last(x); }, false, {Wrap::clamp, Wrap::repeat});
    const auto along =
        image_of(64, 64, [&](int, int y) { return last(y); }, false, {Wrap::repeat, Wrap::clamp});
    const ImageFootprint footprint = round_footprint(0.15f);
    for (const float beyond : {-3.5f, 1.3f, 1.5f, 7.5f})
        for (const float inside : {0.1f, 0.5f, 1.5f}) {
            const float expected = beyond < 0 ? 0.2f : 0.8f;
            EXPECT_NEAR(across.value({beyond, inside}, Filter::ewa, footprint, 8), expected, 1e-5f);
            EXPECT_NEAR(along.value({inside, beyond}, Filter::ewa, footprint, 8), expected, 1e-5f);
        }
}

TEST(TextureFilter, LargeFootprintsSeeTheMean) {
    for (const auto& [width, height] : {std::pair{64, 64}, {65, 40}, {48, 7}}) {
        const TextureImage image = noise(width, height);
        double mean = 0;
        for (size_t i = 0; i < size_t(width * height); ++i)
            mean += image.value(i) / (width * height);
        Rng rng(2);
        for (const Filter f : kFilters)
            for (int i = 0; i < 100; ++i)
                for (const float radius : {1.0f, 1e3f, 1e7f})  // soon, however large
                    // Odd sizes weigh their last row and column a little more.
                    ASSERT_NEAR(image.value(rng.next_2d(), f, round_footprint(radius), 8), mean,
                                width == height ? 1e-5 : 0.06);
    }
}

TEST(TextureFilter, TheMeanOverAllPlacesStays) {
    const TextureImage image = noise(64, 64);
    double mean = 0;
    for (size_t i = 0; i < 64 * 64; ++i) mean += image.value(i) / (64 * 64);
    for (const Filter f : kFilters)
        for (const float radius : {0.01f, 0.03f, 0.07f}) {
            double sum = 0;
            constexpr int n = 256;  // sees every texel of every level equally often
            for (int i = 0; i < n * n; ++i)
                sum += image.value({(float(i % n) + 0.5f) / n, (float(i / n) + 0.5f) / n}, f,
                                   round_footprint(radius), 8);
            // An ellipse is normalised place by place, which a sampled Gaussian is not exactly.
            EXPECT_NEAR(sum / (n * n), mean, f == Filter::ewa ? 2e-4 : 1e-6) << radius;
        }
}

TEST(TextureFilter, AnEllipseKeepsWhatRunsAlongIt) {
    // The image has stripes of four texels that run along s; the footprint is 24 x 2 texels.
    const TextureImage image =
        image_of(64, 64, [](int, int y) { return y / 4 % 2 == 0 ? 1.0f : 0.0f; });
    const ImageFootprint along{{24.0f / 64, 0}, {0, 2.0f / 64}},
        across{{2.0f / 64, 0}, {0, 24.0f / 64}};
    const Vec2 bright{0.4f, 2.0f / 64};
    EXPECT_GT(image.value(bright, Filter::ewa, along, 16), 0.85f);
    EXPECT_NEAR(image.value(bright, Filter::ewa, across, 16), 0.5f, 0.05f);
    // A round filter has to be as wide as the footprint is long.
    EXPECT_NEAR(image.value(bright, Filter::trilinear, along, 16), 0.5f, 0.05f);
    // An ellipse that may not be long has to be as wide, too.
    EXPECT_NEAR(image.value(bright, Filter::ewa, along, 1), 0.5f, 0.05f);
}

TEST(TextureFilter, IsTheGaussianOfTheEllipse) {
    // The filter is compared with the sum over all texels of the finest level, where level 0 is
    // looked up: the short axis is a texel.
    const TextureImage image = noise(128, 128);
    const Vec2 st{0.37f, 0.59f};
    const Vec2 a{5.0f / 128, 3.0f / 128}, b{-0.5f / 128, 0.8f / 128};
    const Vec2 p{a.x * 128, a.y * 128}, q{b.x * 128, b.y * 128};
    // The ellipse is (x, y) = p cos + q sin widened by a texel's own radius; this is its
    // covariance.
    const double xx = p.x * p.x + q.x * q.x + 1, xy = p.x * p.y + q.x * q.y,
                 yy = p.y * p.y + q.y * q.y + 1, determinant = xx * yy - xy * xy;
    double sum = 0, weights = 0;
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x) {
            const double dx = x + 0.5 - st.x * 128.0, dy = y + 0.5 - st.y * 128.0;
            const double r2 = (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / determinant;
            if (r2 >= 1) continue;
            const double w = std::exp(-2 * r2) - std::exp(-2.0);
            sum += w * image.value(size_t(y * 128 + x));
            weights += w;
        }
    EXPECT_NEAR(image.value(st, Filter::ewa, {a, b}, 8), sum / weights, 1e-4);
}

TEST(TextureFilter, StrangeFootprintsGiveFiniteValues) {
    const TextureImage image = noise(16, 16);
    const float inf = kInfinity, nan = std::numeric_limits<float>::quiet_NaN();
    for (const Filter f : kFilters)
        for (const float x : {0.0f, 1e-30f, 1.0f, 1e4f, 1e12f, 1e30f, inf, nan})
            for (const float y : {0.0f, 1.0f, 1e4f, 1e12f, 1e30f, nan})
                for (const float s : {0.3f, 1e30f, nan}) {
                    const float v = image.value({s, 0.5f}, f, {{x, y}, {y, -x}}, 8);
                    ASSERT_TRUE(v >= 0.19f && v <= 0.81f) << x << " " << y << " " << s << ": " << v;
                }
}

TEST(TextureFilter, AnEllipseOverManyRepeatsIsTheCoarsestLevel) {
    const TextureImage image = noise(16, 16);
    // A lookup of all texels of such a footprint would not end.
    for (const float longer : {100.0f, 1e4f, 1e12f}) {
        const float v =
            image.value({0.3f, 0.5f}, Filter::ewa, {{longer, 0}, {0, 0.5f * longer}}, 8);
        EXPECT_EQ(v, image.value({0.3f, 0.5f}, Filter::trilinear, {{1e9f, 0}, {0, 1e9f}}, 8));
    }
}

TEST(TextureFilter, FootprintsTurnWithTheMapping) {
    TexturePoint at;
    at.footprint.dp = {Vec3{1, 0, 0}, Vec3{0, 1, 0}};
    at.footprint.duv = {Vec2{0.5f, 0}, Vec2{0, 0.25f}};
    TextureMapping mapping;
    mapping.scale_u = mapping.scale_v = 0;
    mapping.u_per_v = 3;
    mapping.v_per_u = -2;
    const ImageFootprint turned = image_footprint(mapping, at);
    EXPECT_FLOAT_EQ(turned.a.x, 0);
    EXPECT_FLOAT_EQ(turned.a.y, -1);
    EXPECT_FLOAT_EQ(turned.b.x, 0.75f);
    EXPECT_FLOAT_EQ(turned.b.y, 0);
}

TEST(TextureFilter, FootprintOnATiltedPlane) {
    // The pixel, seen at 60 degrees and of width 0.1, covers 0.1 across and 0.2 along the tilt.
    SurfaceHit hit;
    hit.ng = hit.ns = {0, 0, 1};
    hit.dpdu = {4, 0, 0};
    hit.dpdv = {0, 0.5f, 0};
    const Vec3 w = normalize(Vec3{std::sqrt(3.0f), 0, 1});
    const PointFootprint f = footprint_on(hit, w, 0.1f);
    EXPECT_NEAR(length(f.dp[0]), 0.1f, 1e-6f);
    EXPECT_NEAR(std::abs(f.dp[0].y), 0.1f, 1e-6f);
    EXPECT_NEAR(std::abs(f.dp[1].x), 0.2f, 1e-6f);
    EXPECT_NEAR(std::abs(f.duv[0].y), 0.2f, 1e-6f);
    EXPECT_NEAR(std::abs(f.duv[1].x), 0.05f, 1e-6f);
    EXPECT_NEAR(f.duv[0].x, 0, 1e-6f);
    EXPECT_TRUE(footprint_on(hit, w, 0).is_point());
    // The footprint is round where it is seen straight on.
    const PointFootprint round = footprint_on(hit, {0, 0, 1}, 0.1f);
    EXPECT_NEAR(length(round.dp[0]), 0.1f, 1e-6f);
    EXPECT_NEAR(length(round.dp[1]), 0.1f, 1e-6f);
    EXPECT_NEAR(dot(round.dp[0], round.dp[1]), 0, 1e-8f);
}

}  // namespace
}  // namespace covtrace
