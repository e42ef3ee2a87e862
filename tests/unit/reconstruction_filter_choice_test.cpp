/// The choice among filters: the wide one where it is right, the narrow one where it is not.
#include "reconstruction/filter_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace covtrace {
namespace {

constexpr int kWidth = 64, kHeight = 48;
constexpr size_t kPixels = size_t(kWidth) * kHeight;

/// Flat light of luminance 1 with noise of deviation 0.2; a narrow mean of 4 pixels and a wide one
/// of 100 that is off by `bias`.
struct Flat {
    RawLuminance raw{Plane(kWidth, kHeight), Plane(kWidth, kHeight, 0.04f),
                     std::vector<bool>(kPixels, true)};
    std::vector<FilteredImage> candidates;

    explicit Flat(float bias, uint32_t seed = 1) {
        std::mt19937 random(seed);
        std::normal_distribution<float> normal;
        for (float& v : raw.value.values) v = 1 + 0.2f * normal(random);
        FilteredImage narrow{std::vector<Rgb>(kPixels), std::vector<float>(kPixels, 0.01f),
                             std::vector<float>(kPixels, 0.25f)};
        FilteredImage wide{std::vector<Rgb>(kPixels, Rgb(1 + bias)),
                           std::vector<float>(kPixels, 0.0004f),
                           std::vector<float>(kPixels, 0.01f)};
        for (size_t i = 0; i < kPixels; ++i)
            narrow.color[i] =
                Rgb(0.75f + 0.25f * raw.value[i] + std::sqrt(3.0f) / 4 * 0.2f * normal(random));
        candidates = {narrow, wide};
    }
    double wide_share() const {
        double sum = 0;
        const std::vector<Plane> shares = choose_filters(raw, candidates);
        for (size_t i = 0; i < kPixels; ++i) {
            EXPECT_NEAR(shares[0][i] + shares[1][i], 1, 1e-5f);
            sum += double(shares[1][i]);
        }
        return sum / kPixels;
    }
};

/// About 50 pixels tell each estimate: its deviation is sqrt(2 / 50) of 0.04, as large as the
/// difference of 0.01 between the errors, but most of it is common to both candidates.
TEST(FilterChoice, TakesTheWideFilterWhereItIsRight) {
    EXPECT_GT(Flat(0).wide_share(), 0.8);
}

TEST(FilterChoice, TakesTheNarrowFilterWhereTheWideOneIsWrong) {
    EXPECT_LT(Flat(0.3f).wide_share(), 0.02);
    EXPECT_LT(Flat(-0.3f).wide_share(), 0.02);
}

TEST(FilterChoice, IsCautiousWhereNothingIsKnown) {
    Flat flat(0);
    flat.raw.known.assign(kPixels, false);
    EXPECT_EQ(flat.wide_share(), 0);
}

/// A bright point that a wide filter spreads is one pixel of many, which a mean with limits for
/// outliers would not tell.
TEST(FilterChoice, LeavesOutAFilterThatAPixelContradicts) {
    Flat flat(0);
    const size_t point = size_t(20) * kWidth + 20;
    flat.raw.value[point] = 30;
    flat.candidates[0].color[point] = Rgb(30.0f);
    const std::vector<Plane> shares = choose_filters(flat.raw, flat.candidates);
    EXPECT_LT(shares[1][point], 0.2f);
}

/// Rare bright light that most pixels have not met: none of those contradicts the mean.
TEST(FilterChoice, LetsPixelsMissRareLight) {
    Flat flat(0);
    std::mt19937 random(5);
    for (size_t i = 0; i < kPixels; ++i) {
        const bool meets = random() % 20 == 0;
        flat.raw.value[i] = meets ? 20.0f : 1e-3f;
        flat.raw.variance[i] = meets ? 400.0f : 1e-8f;
        flat.candidates[0].color[i] = Rgb(meets ? 5.75f : 0.75f);
        flat.candidates[0].variance[i] = 25;
    }
    for (float& v : flat.candidates[1].variance) v = 0.2f;
    EXPECT_GT(flat.wide_share(), 0.8);
}

TEST(FilterChoice, DoesNotSpreadLightBeyondSquares) {
    Flat flat(0);
    flat.raw.value[100] = 1e30f;
    flat.raw.variance[100] = INFINITY;
    flat.candidates[1].variance[200] = INFINITY;
    EXPECT_GT(flat.wide_share(), 0.7);
    const FilteredImage image = mixed(flat.candidates, choose_filters(flat.raw, flat.candidates));
    for (size_t i = 0; i < kPixels; ++i)
        EXPECT_TRUE(is_finite(image.color[i]) && std::isfinite(image.variance[i])) << i;
}

}  // namespace
}  // namespace covtrace
