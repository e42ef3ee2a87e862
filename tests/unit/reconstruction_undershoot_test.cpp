// Fits that lead below the dark beside what is bright.
#include "reconstruction/undershoot.h"

#include <gtest/gtest.h>

#include "reconstruction_images.h"

namespace covtrace {
namespace {

using namespace test;

TEST(Undershoot, LightBelowZeroIsCutOff) {
    const Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0, 1);
    std::vector<Candidate> candidates{{halves[0].color, halves[1].color},
                                      {constant(-1), constant(0.7f)}};
    cut_undershoot(candidates, halves);
    for (size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(candidates[0][0][k].values, halves[0].color[k].values);
        EXPECT_FLOAT_EQ(candidates[1][0][k](20, 20), 0);
        EXPECT_FLOAT_EQ(candidates[1][1][k](20, 20), 0.7f);
    }
}

TEST(Undershoot, WhereSamplesAreNegativeCandidatesMayBe) {
    Halves halves = noisy_halves(kSize, kSize, smooth_truth, 0, 1);
    halves[1].color[2](0, 63) = -0.3f;
    std::vector<Candidate> candidates{{halves[0].color, halves[1].color},
                                      {constant(-0.2f), constant(-0.4f)}};
    cut_undershoot(candidates, halves);
    EXPECT_FLOAT_EQ(candidates[1][0][1](0, 63), -0.2f);
    EXPECT_FLOAT_EQ(candidates[1][1][1](5, 62), -0.4f);
}

}  // namespace
}  // namespace covtrace
