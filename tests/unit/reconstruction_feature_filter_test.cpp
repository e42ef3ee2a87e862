// Features: noisy ones lose their noise, others stay.
#include "reconstruction/feature_filter.h"

#include <gtest/gtest.h>

#include <random>

#include "core/vec.h"

namespace covtrace {
namespace {

TEST(FeatureFilter, TakesNoiseAndNothingElse) {
    // The image has a texture without noise on its left, an even feature with noise on its right;
    // between them lies less than a block of neither.
    constexpr int kWidth = 160, kHeight = 40, kTextured = 64, kNoisy = 80;
    constexpr float kSigma = 0.1f;
    Halves halves{HalfBuffer(kWidth, kHeight), HalfBuffer(kWidth, kHeight)};
    std::mt19937 random(1);
    std::uniform_real_distribution<float> texture(0, 1);
    std::normal_distribution<float> noise(0, kSigma);
    for (size_t f = 0; f < kFeatures; ++f)
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const float detail = x < kTextured ? texture(random) : 0.5f;
                for (HalfBuffer& half : halves) {
                    half.count(x, y) = 4;
                    half.feature[f](x, y) = detail + (x < kNoisy ? 0.0f : noise(random));
                    half.feature_variance[f](x, y) = x < kNoisy ? 0.0f : sqr(kSigma);
                }
            }
    const std::array<FeaturePlanes, 2> filtered = filter_features(halves);
    for (size_t k = 0; k < 2; ++k)
        for (size_t f = 0; f < kFeatures; ++f) {
            double squares = 0;
            for (int y = 0; y < kHeight; ++y) {
                for (int x = 0; x < kTextured; ++x)
                    ASSERT_NEAR(filtered[k][f](x, y), halves[k].feature[f](x, y), 1e-5f) << x;
                for (int x = kNoisy; x < kWidth; ++x)
                    squares += double(sqr(filtered[k][f](x, y) - 0.5f));
            }
            // The windows are 121 pixels, nearly all of which are alike.
            EXPECT_LT(std::sqrt(squares / ((kWidth - kNoisy) * kHeight)), 0.3f * kSigma);
        }
}

}  // namespace
}  // namespace covtrace
