// Fits that lead below the dark beside what is bright.
#include "reconstruction/undershoot.h"

#include <gtest/gtest.h>

#include "reconstruction_images.h"

namespace covtrace {
namespace {

using namespace test;

/// A mixture of equal shares of the first two of three candidates.
Selection mixture_of(const std::vector<Candidate>& c) {
    Selection s;
    s.share = {Plane(kSize, kSize, 0.5f), Plane(kSize, kSize, 0.5f), Plane(kSize, kSize, 0.0f)};
    for (size_t half = 0; half < 2; ++half) {
        s.half[half] = c[0][half];
        for (size_t k = 0; k < 3; ++k)
            for (size_t i = 0; i < s.half[half][k].size(); ++i)
                s.half[half][k][i] = 0.5f * (c[0][half][k][i] + c[1][half][k][i]);
    }
    return s;
}

TEST(Undershoot, HolesGetTheLightOfTheDarkestCandidateAboveZero) {
    const Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0, 1);
    const std::vector<Candidate> candidates{{constant(0.3f), constant(0.3f)},
                                            {constant(-1), constant(-0.1f)},
                                            {constant(0.4f), constant(0.2f)}};
    Selection s = mixture_of(candidates);
    fill_undershoot(candidates, halves, s);
    for (size_t k = 0; k < 3; ++k) {
        EXPECT_FLOAT_EQ(s.half[0][k](20, 20), 0.3f);
        EXPECT_FLOAT_EQ(s.half[1][k](20, 20), 0.1f) << "no hole";
    }
    EXPECT_FLOAT_EQ(without_undershoot(constant(-1), halves)[1](3, 4), 0);
}

TEST(Undershoot, HolesGetNothingOfAFitThatLeadsFarAboveTheDark) {
    const Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0, 1);
    const std::vector<Candidate> candidates{{constant(0.236f), constant(0.236f)},
                                            {constant(-0.3f), constant(-0.3f)},
                                            {constant(0.001f), constant(0.001f)}};
    Selection s = mixture_of(candidates);
    fill_undershoot(candidates, halves, s);
    EXPECT_FLOAT_EQ(s.half[0][1](20, 20), 0.001f) << "the samples' light, though without a share";
}

TEST(Undershoot, WhereSamplesAreNegativeMixturesMayBe) {
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0, 1);
    halves[1].color[2](0, 63) = -0.3f;
    const std::vector<Candidate> candidates{{constant(-0.2f), constant(0.1f)},
                                            {constant(-0.4f), constant(-0.3f)},
                                            {constant(-0.2f), constant(0.2f)}};
    Selection s = mixture_of(candidates);
    fill_undershoot(candidates, halves, s);
    EXPECT_FLOAT_EQ(s.half[0][1](0, 63), -0.3f);
    EXPECT_FLOAT_EQ(s.half[1][1](5, 62), -0.1f);
    EXPECT_FLOAT_EQ(without_undershoot(constant(-1), halves)[1](3, 60), -1);
    // Further away than a fit reaches holes are filled
    EXPECT_FLOAT_EQ(s.half[0][1](10, 63), 0);
    EXPECT_FLOAT_EQ(s.half[1][1](0, 53), 0.1f);
    EXPECT_FLOAT_EQ(without_undershoot(constant(-1), halves)[1](3, 4), 0);
}

}  // namespace
}  // namespace covtrace
