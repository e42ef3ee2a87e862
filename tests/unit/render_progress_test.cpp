// Reports of a render's progress: how often they come, and that each phase has one.
#include "render/progress.h"

#include <gtest/gtest.h>

#include <vector>

namespace covtrace::test {
namespace {

TEST(RenderProgress, TellsEachPhaseAtOnceAndTheRestAtIntervals) {
    std::vector<Progress> told;
    Monitor monitor([&](const Progress& p) { told.push_back(p); }, 3600);
    monitor.update(Phase::radiance, 0.1, 1);
    monitor.update(Phase::radiance, 0.2, 2);
    monitor.update(Phase::reconstruction, 0.97, 3);
    monitor.update(Phase::reconstruction, 0.98, 3);
    ASSERT_EQ(told.size(), 2u);
    EXPECT_EQ(told[0].phase, Phase::radiance);
    EXPECT_EQ(told[1].phase, Phase::reconstruction);
    EXPECT_EQ(told[1].fraction, 0.97);
}

}  // namespace
}  // namespace covtrace::test
