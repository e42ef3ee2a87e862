// Two densities lose their noise and keep what both know.
#include "planner/agreement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/rng.h"
#include "core/vec.h"

namespace covtrace {
namespace {

constexpr int kSize = 128;

/// A density whose root is `truth(x, y)` times numbers in 1 - noise..1 + noise.
template <typename Truth>
Plane noisy(const Truth& truth, float noise, uint64_t seed) {
    Rng rng(seed);
    Plane density(kSize, kSize);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x)
            density(x, y) = sqr(truth(x, y) * (1 + noise * (2 * rng.next_float() - 1)));
    return density;
}

/// Mean squared difference of the roots of a density and the truth's, both with mean 1.
template <typename Truth>
double loss(const Plane& density, const Truth& truth) {
    const Plane exact = noisy(truth, 0, 0);
    double sum = 0, sum_exact = 0, squares = 0;
    for (size_t i = 0; i < density.size(); ++i) {
        sum += double(density[i]);
        sum_exact += double(exact[i]);
    }
    for (size_t i = 0; i < density.size(); ++i)
        squares +=
            sqr(std::sqrt(double(density[i]) / sum) - std::sqrt(double(exact[i]) / sum_exact));
    return squares;
}

float halves_of_the_image(int x, int) {
    return x < kSize / 2 ? 1.0f : 3.0f;
}
float thin_stripes(int x, int) {
    return x % 4 < 2 ? 1.0f : 3.0f;
}

TEST(KeepWhatAgrees, KeepsWhatIsCertain) {
    for (const auto truth : {halves_of_the_image, thin_stripes}) {
        std::array density{noisy(truth, 0, 1), noisy(truth, 0, 2)};
        for (float& v : density[1].values) v *= 3;  // a density knows no units
        keep_what_agrees(density);
        for (const Plane& d : density)
            for (int x = 0; x < kSize; ++x) EXPECT_NEAR(d(x, 9), sqr(truth(x, 9)) / 5, 1e-4);
    }
}

// A half that the noise of pixels hides in single ones is known in the mean of many. The noise of
// kSize^2 pixels is the same in all runs; its squares are known to a percent.
TEST(KeepWhatAgrees, DropsTheNoiseOfPixels) {
    std::array density{noisy(halves_of_the_image, 0.8f, 1), noisy(halves_of_the_image, 0.8f, 2)};
    const double before = loss(density[0], halves_of_the_image);
    // The best that a share of the whole, one for all bands, could do
    double best_even = before;
    for (float share = 0; share < 1; share += 0.02f) {
        Plane mixed = density[0];
        double sum = 0;
        for (float v : mixed.values) sum += double(v) / double(mixed.size());
        for (float& v : mixed.values) v = (1 - share) * v + share * float(sum);
        best_even = std::min(best_even, loss(mixed, halves_of_the_image));
    }
    keep_what_agrees(density);
    for (const Plane& d : density) EXPECT_LT(loss(d, halves_of_the_image), 0.3 * best_even);
}

TEST(KeepWhatAgrees, WithoutAgreementCountsAreEven) {
    const auto even = [](int, int) { return 1.0f; };
    std::array density{noisy(even, 0.9f, 3), noisy(even, 0.9f, 4)};
    keep_what_agrees(density);
    for (const Plane& d : density) {
        const auto [least, most] = std::minmax_element(d.values.begin(), d.values.end());
        EXPECT_GT(*least, 0.9f);
        EXPECT_LT(*most, 1.1f);
    }
    // Plans that contradict each other are worth no more
    std::array against{noisy(thin_stripes, 0, 1), noisy(thin_stripes, 0, 1)};
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) against[1](x, y) = thin_stripes(x + 2, y);
    keep_what_agrees(against);
    for (float v : against[0].values) EXPECT_NEAR(v, 1, 0.05f);
}

TEST(KeepWhatAgrees, BlackIsEven) {
    std::array<Plane, 2> density{Plane(kSize, kSize), Plane(kSize, kSize)};
    keep_what_agrees(density);
    for (float v : density[0].values) EXPECT_EQ(v, 1);
}

}  // namespace
}  // namespace covtrace
