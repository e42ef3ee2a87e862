// Likeness: the pixels that judge together.
#include "reconstruction/likeness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "reconstruction/guides.h"
#include "reconstruction/selector.h"
#include "reconstruction_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

constexpr int kWidth = 40, kHeight = 30;

/// A plane that is 1 in the right half, 0 in the left one.
Plane right_half() {
    Plane p(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = kWidth / 2; x < kWidth; ++x) p(x, y) = 1;
    return p;
}

float sum_around(const Plane& plane, const Likeness& likeness, int x, int y) {
    Likeness::Window weights;
    likeness.weigh(x, y, weights);
    const MarginPlane values(plane);
    float sum = 0;
    weighted_sums({&values, 1}, weights, x, y, &sum);
    return sum;
}

/// The sum by its definition, term by term.
float expected(const Plane& plane, const Plane& guide, const LikenessSettings& settings, int x,
               int y) {
    double sum = 0;
    for (int v = 0; v < kHeight; ++v)
        for (int u = 0; u < kWidth; ++u) {
            if (std::abs(u - x) > Likeness::kReach || std::abs(v - y) > Likeness::kReach) continue;
            const double far = std::hypot(u - x, v - y) / double(settings.sigma),
                         unlike = double(guide(x, y) - guide(u, v)), any = double(settings.any);
            sum += std::exp(-0.5 * far * far) *
                   (any + (1 - any) * std::exp(-0.5 * unlike * unlike)) * double(plane(u, v));
        }
    return float(sum);
}

TEST(Likeness, MostIsTheSumOfPixelsOfTheImageAlone) {
    const Likeness likeness({});  // without guides all pixels are alike
    const Plane ones(kWidth, kHeight, 1);
    for (const auto& [x, y] : {std::pair{0, 0}, {3, 15}, {20, 15}, {39, 29}}) {
        const float sum = sum_around(ones, likeness, x, y);
        EXPECT_NEAR(likeness.most(x, y, kWidth, kHeight), sum, 1e-4f * sum);
    }
}

TEST(Likeness, WeighsAsDefinedUpToTheImagesBorder) {
    Plane guide(kWidth, kHeight), plane(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            guide(x, y) = 2 * std::sin(0.7f * float(x) + 0.3f * float(y));
            plane(x, y) = 1 + 0.5f * std::cos(0.9f * float(x * y));
        }
    const LikenessSettings settings{4, 0.1f};
    Likeness likeness(settings);
    likeness.add(guide);
    for (const auto& [x, y] : {std::pair{20, 15}, {0, 0}, {kWidth - 1, kHeight - 1}, {3, 28}}) {
        const float sum = expected(plane, guide, settings, x, y);
        EXPECT_NEAR(sum_around(plane, likeness, x, y), sum, 1e-4f * sum) << x << ", " << y;
    }
}

TEST(Likeness, GuidesAddUp) {
    Likeness none(LikenessSettings{6, 0}), one = none, two = none;
    const Plane half = right_half(), white(kWidth, kHeight, 1);
    one.add(half);
    two.add(half);
    two.add(half);
    const int x = kWidth / 2;  // half of the pixels around are on the other side
    const float all = sum_around(white, none, x, 15), right = sum_around(half, none, x, 15),
                left = all - right;
    EXPECT_NEAR(sum_around(white, one, x, 15), right + std::exp(-0.5f) * left, 1e-3f * all);
    EXPECT_NEAR(sum_around(white, two, x, 15), right + std::exp(-1.0f) * left, 1e-3f * all);
}

TEST(Selector, JudgesEachSideOfABorderByItself) {
    // The first candidate is right on the left of the border, the second on its right.
    const Plane half = right_half();
    const auto truth = [&](int, int) { return 1.0f; };
    const Halves halves = noisy_halves(kWidth, kHeight, truth, 0.1f, 5);
    ColorPlanes left, right, ones;
    ones.fill(Plane(kWidth, kHeight, 1));
    for (size_t c = 0; c < 3; ++c) {
        left[c] = right[c] = Plane(kWidth, kHeight, 1);
        for (size_t i = 0; i < half.size(); ++i) {
            left[c][i] += 0.5f * half[i];
            right[c][i] += 0.5f * (1 - half[i]);
        }
    }
    const std::vector<Candidate> candidates{{left, left}, {right, right}};
    const ColorPlanes g = error_weights(halves, ones);
    Plane guide = half;
    for (float& v : guide.values) v *= 10;
    Likeness alike(LikenessSettings{6, 0.02f});
    alike.add(guide);
    const double apart = mean_squared_error(select(halves, candidates, g, alike).half[0], truth),
                 together = mean_squared_error(select(halves, candidates, g, 6).half[0], truth);
    EXPECT_LT(apart, 0.25 * together);
}

TEST(Selector, PixelsBesideABorderAreJudgedThemselves) {
    // The image is as above, but without noise; its border passes all columns and is nowhere
    // between pixels that share their mixture.
    const auto is_right = [](int x, int y) { return x > 8 + 0.7f * float(y) ? 1.0f : 0.0f; };
    Halves halves{HalfBuffer(kWidth, kHeight), HalfBuffer(kWidth, kHeight)};
    ColorPlanes left, right, ones;
    ones.fill(Plane(kWidth, kHeight, 1));
    left.fill(Plane(kWidth, kHeight));
    right = left;
    Plane guide(kWidth, kHeight);
    for (HalfBuffer& half : halves) {
        half.color = ones;
        half.count = ones[0];
    }
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            guide(x, y) = 10 * is_right(x, y);
            for (size_t c = 0; c < 3; ++c) {
                left[c](x, y) = 1 + 0.5f * is_right(x, y);
                right[c](x, y) = 1.5f - 0.5f * is_right(x, y);
            }
        }
    Likeness likeness(LikenessSettings{6, 0});
    likeness.add(guide);
    const Selection s = select(halves, std::vector<Candidate>{{left, left}, {right, right}},
                               error_weights(halves, ones), likeness);
    for (int y = 2; y < kHeight - 2; ++y)
        for (int x = 2; x < kWidth - 2; ++x) {
            bool beside = false;  // shares are smoothed over half a pixel
            for (int v = -2; v <= 2; ++v)
                for (int u = -2; u <= 2; ++u)
                    beside = beside || is_right(x + u, y + v) != is_right(x, y);
            if (beside) continue;
            ASSERT_NEAR(s.half[0][0](x, y), 1, 0.01f) << x << " " << y;
        }
}

TEST(Guides, TellNoisyFromCleanAndBrightFromDark) {
    const auto one = [](int, int) { return 1.0f; };
    Halves halves = noisy_halves(kWidth, kHeight, one, 0.1f, 6);
    const Plane half = right_half(), white(kWidth, kHeight, 1);
    ColorPlanes guess;
    guess.fill(white);
    // The share is that of the weight around a pixel at the border that lies on its own side.
    const auto own_side = [&] {
        Likeness likeness(LikenessSettings{6, 0});
        add_features(halves, likeness);
        add_light_and_noise(halves, guess, likeness);
        const int x = kWidth / 2 + 3;  // the guides are blurred by a pixel
        return sum_around(half, likeness, x, 15) / sum_around(white, likeness, x, 15);
    };
    const float nothing_told = own_side();
    EXPECT_LT(nothing_told, 0.8f);
    for (size_t i = 0; i < half.size(); ++i)
        for (HalfBuffer& h : halves)
            for (Plane& v : h.color_variance)
                if (half[i] > 0) v[i] *= 100;
    EXPECT_GT(own_side(), 0.95f);
    for (HalfBuffer& h : halves) h.color_variance.fill(Plane(kWidth, kHeight, 0.01f));
    EXPECT_NEAR(own_side(), nothing_told, 0.05f);
    for (Plane& p : guess)
        for (size_t i = 0; i < half.size(); ++i) p[i] += 3 * half[i];
    EXPECT_GT(own_side(), 0.95f);
    guess.fill(white);
    for (HalfBuffer& h : halves)
        for (size_t i = 0; i < half.size(); ++i) h.feature[0][i] += half[i];
    EXPECT_GT(own_side(), 0.95f);
}

}  // namespace
}  // namespace covtrace
