// The limit of learning: a quarter of the time that was left at the first question, or a
// cancellation.
#include "render/learning_limit.h"

#include <gtest/gtest.h>

#include <chrono>

namespace covtrace {
namespace {

/// A monitor of a render that began so many seconds ago.
Monitor begun_before(double seconds) {
    return Monitor({}, 0.1,
                   Monitor::Clock::now() - std::chrono::duration_cast<Monitor::Clock::duration>(
                                               std::chrono::duration<double>(seconds)));
}

TEST(LearningLimit, IsAQuarterOfTheTimeThatWasLeft) {
    RenderOptions options;
    options.seconds = 1000.0;
    const Monitor monitor = begun_before(600);
    const auto stop = learning_limit(monitor, options);
    EXPECT_FALSE(stop());  // 100 s from now on
    options.seconds = 599.0;
    const auto late = learning_limit(monitor, options);
    EXPECT_TRUE(late());
    options.seconds = 601.0;
    const auto soon = learning_limit(monitor, options);
    const double before = monitor.elapsed();
    while (!soon()) continue;
    EXPECT_GE(monitor.elapsed(), before + 0.25 * (601 - before));
    EXPECT_FALSE(stop());
}

TEST(LearningLimit, IsNoneWithoutABudgetOfTime) {
    Monitor monitor = begun_before(1e6);
    const auto stop = learning_limit(monitor, {});
    EXPECT_FALSE(stop());
    monitor.cancel();
    EXPECT_TRUE(stop());
}

}  // namespace
}  // namespace covtrace
