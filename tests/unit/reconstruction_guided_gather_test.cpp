/// The gather led by features: texture passes whole, other surfaces take no part, noise falls.
#include "reconstruction/guided_gather.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace covtrace {
namespace {

constexpr int kWidth = 64, kHeight = 48;
constexpr size_t kPixels = size_t(kWidth) * kHeight;

/// A scene of features and light, gathered through round filters of one pixel.
struct View {
    std::vector<Rgb> mean = std::vector<Rgb>(kPixels, Rgb(1.0f));
    std::vector<float> variance = std::vector<float>(kPixels, 0.01f);
    std::vector<uint32_t> count = std::vector<uint32_t>(kPixels, 16);
    FilterGuides guides{std::vector<Rgb>(kPixels, Rgb(0.5f)),
                        std::vector<Rgb>(kPixels, Rgb(0, 0, 1)), std::vector<float>(kPixels, 0.0f)};

    std::vector<FilteredImage> gathered() const {
        const FilterField field{kWidth, kHeight,
                                std::vector(kPixels, covariance::Sym2<float>{1, 0, 1})};
        return guided_gather(mean, variance, count, field, guides);
    }
};

size_t at(int x, int y) {
    return size_t(y) * kWidth + size_t(x);
}

TEST(GuidedGather, KeepsATextureUnderEvenLight) {
    View view;
    for (size_t i = 0; i < kPixels; ++i) {
        view.guides.albedo[i] = Rgb(0.2f + 0.2f * float(i % 3), 0.5f, 0.8f - 0.3f * float(i % 2));
        view.mean[i] = 3 * view.guides.albedo[i];
    }
    const auto images = view.gathered();
    for (size_t k = 0; k < images.size(); k += 2)
        for (size_t i = 0; i < kPixels; ++i)
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(images[k].color[i][c], view.mean[i][c], 1e-4f * view.mean[i][c]) << i;
}

/// A coat reflects the same light, 0.3, over a texture of albedos 0.1 and 0.3: divided by them it
/// would be three times as bright on one as on the other.
TEST(GuidedGather, KeepsWhatACoatReflectsOverATexture) {
    View view;
    view.mean.assign(kPixels, Rgb(0.3f));
    for (size_t i = 0; i < kPixels; ++i) view.guides.albedo[i] = Rgb(i % 2 == 0 ? 0.1f : 0.3f);
    const auto images = view.gathered();
    for (size_t k = 0; k < images.size(); k += 2) {
        EXPECT_GT(std::abs(images[k].color[at(33, 20)].g - 0.3f), 0.05f);
        for (size_t i = 0; i < kPixels; ++i)
            ASSERT_NEAR(images[k + 1].color[i].g, 0.3f, 1e-4f) << i;
    }
}

/// Two surfaces that meet in a vertical line, told apart by each feature in turn: without it, a
/// filter of four pixels carries 2 % and more of the other side's light over the line.
TEST(GuidedGather, TakesNothingOfAnotherSurface) {
    for (int feature = 0; feature < 3; ++feature) {
        View view;
        for (size_t i = 0; i < kPixels; ++i) {
            if (i % kWidth < kWidth / 2) continue;
            view.mean[i] = Rgb(2.0f);
            if (feature == 0) view.guides.normal[i] = Rgb(1, 0, 0);
            if (feature == 1) view.guides.log_distance[i] = 1;
        }
        const FilteredImage widest = view.gathered().back();
        const float leak = std::abs(widest.color[at(kWidth / 2 - 1, 20)].g - 1);
        if (feature < 2)
            EXPECT_LT(leak, 1e-3f) << feature;
        else
            EXPECT_GT(leak, 0.3f);
    }
}

/// Means over N pixels have 1/N of the noise: of a round Gaussian of s pixels N = 4 pi s^2. The
/// standard error of a deviation over some 3000 / (4 pi 16) = 15 independent means is 18 %; within
/// 50 %, 2.7 of them: a false alarm in 1 of 150 at the widest scale, with this seed none.
TEST(GuidedGather, LowersNoiseAsItTells) {
    View view;
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    for (Rgb& m : view.mean) m = Rgb(1 + 0.1f * normal(random));
    const auto images = view.gathered();
    for (size_t k = 0; k < images.size(); ++k) {
        const float s = kGuidedScales[k / 2];
        const size_t middle = at(kWidth / 2, kHeight / 2);
        EXPECT_NEAR(images[k].variance[middle], 0.01f / (4 * 3.14159f * s * s),
                    0.03f * images[k].variance[middle]);
        EXPECT_NEAR(images[k].own_weight[middle], 1 / (2 * 3.14159f * s * s),
                    0.03f * images[k].own_weight[middle]);
        double sum = 0;
        for (const Rgb& c : images[k].color) sum += double(sqr(c.g - 1));
        EXPECT_NEAR(std::sqrt(sum / kPixels), 0.1 / std::sqrt(4 * 3.14159 * s * s),
                    0.5 * 0.1 / std::sqrt(4 * 3.14159 * s * s))
            << s;
    }
}

TEST(GuidedGather, LeavesOutPixelsWithoutSamplesAndWhatIsNotFinite) {
    View view;
    view.count[at(10, 10)] = 0;
    view.mean[at(10, 10)] = Rgb(1000.0f);
    view.mean[at(30, 30)] = Rgb(INFINITY);
    for (const FilteredImage& image : view.gathered()) {
        for (size_t i = 0; i < kPixels; ++i) ASSERT_NEAR(image.color[i].g, 1, 1e-4f) << i;
        EXPECT_EQ(image.own_weight[at(10, 10)], 0);
    }
}

TEST(GuidedGather, SaysWhereNothingIsFound) {
    View view;
    view.count.assign(kPixels, 0);
    for (const FilteredImage& image : view.gathered())
        EXPECT_TRUE(std::isinf(image.variance[0]) && image.color[0] == Rgb());
}

TEST(ScaledFilter, IsNoWiderThanTheWidest) {
    EXPECT_FLOAT_EQ(scaled_filter({1, 0, 1}, 2).xx, 4);
    EXPECT_FLOAT_EQ(scaled_filter({4, 0, 4}, 4).xx, sqr(kWidestScaled));
    EXPECT_FLOAT_EQ(scaled_filter({100, 0, 100}, 1).xx, sqr(kWidestScaled));
}

}  // namespace
}  // namespace covtrace
