// The share of raw pixels: less where a pixel is noisier than those around it.
#include "reconstruction/raw_share.h"

#include <gtest/gtest.h>

#include "reconstruction/likeness.h"
#include "reconstruction_images.h"

namespace covtrace {
namespace {

using namespace test;

constexpr float kShare = 0.2f, kNoise = 0.01f;
constexpr int kMiddle = kSize / 2;

/// Halves of light 1 and noise kNoise, one pixel apart: there A has `in_a`, B has `in_b`, and their
/// spread tells the variance `told` of either.
Halves with_pixel(float in_a, float in_b, float told) {
    Halves halves = noisy_halves(
        kSize, kSize, [](int, int) { return 1.0f; }, 0, 1);
    const float apart = std::sqrt(kNoise);
    for (size_t k = 0; k < 2; ++k)
        for (size_t c = 0; c < 3; ++c) {
            for (size_t i = 0; i < halves[k].count.size(); ++i) {
                halves[k].color[c][i] = 1 + (k == 0 ? apart : -apart);
                halves[k].color_variance[c][i] = 2 * kNoise;
            }
            halves[k].color[c](kMiddle, kMiddle) = k == 0 ? in_a : in_b;
            halves[k].color_variance[c](kMiddle, kMiddle) = told;
        }
    return halves;
}

/// The sums of planes over the pixels around every pixel, all of which are alike.
std::vector<Plane> sums_around(const std::array<Plane, 2>& planes) {
    const std::vector<MarginPlane> within(planes.begin(), planes.end());
    std::vector<Plane> sums(2, Plane(kSize, kSize));
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            Likeness::Window weights;
            Likeness({}).weigh(x, y, weights);
            std::array<float, 2> sum;
            weighted_sums(within, weights, x, y, sum.data());
            for (size_t k = 0; k < 2; ++k) sums[k](x, y) = sum[k];
        }
    return sums;
}

/// The mixture of kShare of the raw pixels with the truth, 1, after the share was lowered.
Selection lowered(const Halves& halves, float share = kShare) {
    const Candidate raw{halves[0].color, halves[1].color};
    Selection s;
    s.share = {Plane(kSize, kSize, share), Plane(kSize, kSize, 1 - share)};
    for (size_t k = 0; k < 2; ++k) {
        s.half[k] = constant(1 - share);
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < raw[k][c].size(); ++i) s.half[k][c][i] += share * raw[k][c][i];
    }
    const std::array<Plane, 2> noise =
        relative_noise(pixel_noise(halves), error_weights(halves, constant(1)));
    lower_share_of_noisy(noise[0], sums_around(noise), raw, s);
    return s;
}

TEST(RawShare, IsThatOfWienersFilterWhereOnePixelIsNoisy) {
    // A alone has met a bright path: (A - B)^2 / 4 = 4 is 400 times the noise around.
    const Halves halves = with_pixel(5, 1, 16);
    const Selection s = lowered(halves);
    // The pixel itself is in the mean over the window
    const float mean =
                    kNoise + (4 - kNoise) / Likeness({}).most(kSize / 2, kSize / 2, kSize, kSize),
                expected = kShare / (kShare + (1 - kShare) * 4 / mean);
    EXPECT_NEAR(s.share[0](kMiddle, kMiddle), expected, 0.01f * expected);
    EXPECT_FLOAT_EQ(s.share[0](kMiddle, kMiddle) + s.share[1](kMiddle, kMiddle), 1);
    // The mixtures are those of the shares
    EXPECT_NEAR(s.half[0][1](kMiddle, kMiddle), 1 + 4 * s.share[0](kMiddle, kMiddle), 1e-5f);
    EXPECT_NEAR(s.half[1][1](kMiddle, kMiddle), 1, 1e-5f);
}

TEST(RawShare, StaysWherePixelsAreAsNoisyAsThoseAround) {
    const Selection s = lowered(with_pixel(1.05f, 0.95f, kNoise));
    EXPECT_FLOAT_EQ(s.share[0](kMiddle, kMiddle), kShare);  // a clean pixel
    EXPECT_FLOAT_EQ(s.share[0](5, 7), kShare);
}

TEST(RawShare, HolesAreNoPixelsWithoutNoise) {
    Halves halves = with_pixel(1 + std::sqrt(kNoise), 1 - std::sqrt(kNoise), 2 * kNoise);
    for (HalfBuffer& half : halves)
        for (size_t i = 0; i < half.count.size(); i += 2) {
            half.count[i] = 0;
            for (size_t c = 0; c < 3; ++c) half.color[c][i] = half.color_variance[c][i] = 0;
        }
    EXPECT_FLOAT_EQ(lowered(halves).share[0](kMiddle + 1, kMiddle), kShare);
}

TEST(RawShare, StaysWhereBothHalvesSeeTheSameDetail) {
    const Selection s = lowered(with_pixel(5.05f, 4.95f, 16));
    EXPECT_FLOAT_EQ(s.share[0](kMiddle, kMiddle), kShare);
}

TEST(RawShare, StaysWholeWhereThePixelsAreRight) {
    const Selection s = lowered(with_pixel(5, 1, 16), 1);
    EXPECT_FLOAT_EQ(s.share[0](kMiddle, kMiddle), 1);
}

}  // namespace
}  // namespace covtrace
