// The count at which an error will be reached, from the errors so far.
#include "planner/error_goal.h"

#include <gtest/gtest.h>

namespace covtrace {
namespace {

TEST(ErrorGoal, AsksForWhatIsMissing) {
    ErrorGoal goal;
    EXPECT_EQ(goal.samples(4, 0.1, 0.1), 4);
    // The errors fall as n^-1/2: four times the samples for half of it, and a margin of 3 %.
    ErrorGoal plain;
    plain.samples(4, 0.4, 0.05);
    EXPECT_NEAR(plain.samples(16, 0.2, 0.1), 64 / (0.97 * 0.97), 0.1);
    // Steps are never too small to be worth a reconstruction.
    EXPECT_NEAR(plain.samples(64, 0.1001, 0.1), 70.4, 1e-6);
}

}  // namespace
}  // namespace covtrace
