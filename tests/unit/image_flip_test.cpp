#include <gtest/gtest.h>

#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>

#include "image/flip.h"

namespace covtrace {
namespace {

double mean(const std::vector<float>& v) {
    return std::accumulate(v.begin(), v.end(), 0.0) / double(v.size());
}

std::vector<Rgb> random_colors(size_t count, uint64_t seed) {
    std::vector<Rgb> colors(count);
    for (Rgb& color : colors)
        for (int c = 0; c < 3; ++c) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            color[c] = float(seed >> 40) * 0x1p-24f;
        }
    return colors;
}

double uniform_flip(Rgb a, Rgb b) {
    const std::vector<Rgb> image(400, a), reference(400, b);
    const auto error = flip_error(image, reference, 20, 20);
    // The filters sum to 1 and 0, borders repeat: a uniform image has the same error everywhere.
    EXPECT_NEAR(*std::min_element(error.begin(), error.end()),
                *std::max_element(error.begin(), error.end()), 2e-3);
    return mean(error);
}

// Uniform images have no features. The rest is the colour difference of Andersson et al. 2020,
// "FLIP: A Difference Evaluator for Alternating Images", by hand from the CIELAB values of the
// primaries: green (87.735, -86.183, 83.179), blue (32.297, 79.188, -107.860), red (53.241, 80.092,
// 67.203). Chroma times L/100 (Hunt); HyAB(green, blue) is 203.30, whose power 0.7 is 41.28, the
// largest difference; 0.4 of it is 16.51.
TEST(Flip, UniformColorsByHand) {
    EXPECT_NEAR(uniform_flip({0, 1, 0}, {0, 0, 1}), 1, 1e-3);
    // Black and white: 100^0.7 = 25.12; 0.95 + 0.05 (25.12 - 16.51) / (41.28 - 16.51)
    EXPECT_NEAR(uniform_flip(Rgb(0), Rgb(1)), 0.96738, 1e-3);
    // Black and red: HyAB = 53.241 + 0.53241 * 104.55 = 108.90, power 0.7 = 26.66
    EXPECT_NEAR(uniform_flip(Rgb(0), {1, 0, 0}), 0.97050, 1e-3);
    // Two greys, Y = 0.2 and 0.25: L* = 51.837 and 57.075, 5.238^0.7 = 3.187; 0.95 * 3.187 / 16.51
    EXPECT_NEAR(uniform_flip(Rgb(0.2f), Rgb(0.25f)), 0.18340, 1e-3);
}

// The authors' implementation (version 1.6) gives these means for the same images.
TEST(Flip, AgreesWithThePublishedImplementation) {
    constexpr int kWidth = 48, kHeight = 32;
    std::vector<Rgb> a(kWidth * kHeight), b(a.size());
    const auto at = [](int x, int y) { return size_t(y) * kWidth + size_t(x); };
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            a[at(x, y)] = x < kWidth / 2 ? Rgb(0, 1, 0) : Rgb(0, 0, 1);
            b[at(x, y)] = y < kHeight / 2 ? Rgb(0, 1, 0) : Rgb(1, 0, 1);
        }
    EXPECT_NEAR(mean(flip_error(b, a, kWidth, kHeight)), 0.842116, 2e-5);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float c = (x / 4 + y / 4) % 2 ? 0.5f : 0.25f;
            a[at(x, y)] = Rgb(c);
            b[at(x, y)] = Rgb(c, c * 0.9f, c * 0.5f + (x % 3 == 0 ? 0.1f : 0.0f));
        }
    EXPECT_NEAR(mean(flip_error(b, a, kWidth, kHeight)), 0.364835, 2e-5);
    EXPECT_NEAR(mean(flip_error(b, a, kWidth, kHeight, 30)), 0.392704, 2e-5);
}

RC_GTEST_PROP(Flip, IsZeroForEqualImagesSymmetricAndBounded, ()) {
    const int width = *rc::gen::inRange(1, 24), height = *rc::gen::inRange(1, 24);
    const size_t count = size_t(width) * size_t(height);
    const auto a = random_colors(count, *rc::gen::arbitrary<uint64_t>());
    const auto b = random_colors(count, *rc::gen::arbitrary<uint64_t>());
    for (float e : flip_error(a, a, width, height)) RC_ASSERT(e == 0);
    const auto ab = flip_error(a, b, width, height), ba = flip_error(b, a, width, height);
    for (size_t i = 0; i < count; ++i) {
        RC_ASSERT(ab[i] == ba[i]);
        RC_ASSERT(ab[i] >= 0 && ab[i] <= 1);
    }
}

TEST(Flip, GrowsWithTheNoise) {
    constexpr int kSize = 64;
    const auto noise = random_colors(kSize * kSize, 9);
    const std::vector<Rgb> reference(noise.size(), Rgb(0.4f));
    double last = 0;
    for (float strength : {0.02f, 0.1f, 0.3f, 0.8f}) {
        std::vector<Rgb> image(noise.size());
        for (size_t i = 0; i < image.size(); ++i) image[i] = lerp(strength, reference[i], noise[i]);
        const double value = mean(flip_error(image, reference, kSize, kSize));
        EXPECT_GT(value, last);
        last = value;
    }
    // The eye averages fine noise from a distance: fewer pixels per degree make it easier to see.
    EXPECT_LT(mean(flip_error(noise, reference, kSize, kSize, 120)),
              mean(flip_error(noise, reference, kSize, kSize, 20)));
}

}  // namespace
}  // namespace covtrace
