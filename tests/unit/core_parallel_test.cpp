#include "core/parallel.h"

#include <gtest/gtest.h>
#include <xmmintrin.h>

#include <atomic>
#include <limits>
#include <vector>

namespace covtrace {
namespace {

TEST(Parallel, VisitsEveryIndexOnce) {
    std::vector<std::atomic<int>> visits(1000);
    parallel_for(1000, [&](int64_t i) { ++visits[size_t(i)]; });
    for (const auto& v : visits) EXPECT_EQ(v, 1);
}

TEST(Parallel, ThrowsWhatABodyThrows) {
    EXPECT_THROW(parallel_for(100,
                              [](int64_t i) {
                                  if (i == 50) throw 7;
                              }),
                 int);
}

// Threads start in the floating-point mode in which the process first used the scheduler. A loop
// must not compute anything else for that: here every test is a process of its own.
TEST(Parallel, ComputesInTheFloatingPointModeOfTheCaller) {
    const auto halves = [] {
        std::vector<float> half(1000);
        volatile float smallest = std::numeric_limits<float>::min();
        parallel_for(1000, [&](int64_t i) { half[size_t(i)] = smallest * 0.5f; });
        return half;
    };
    const unsigned mode = _mm_getcsr();
    _mm_setcsr(mode | _MM_FLUSH_ZERO_ON);
    const std::vector<float> flushed = halves();
    _mm_setcsr(mode);
    const std::vector<float> kept = halves();
    for (const float v : flushed) EXPECT_EQ(v, 0);
    for (const float v : kept) EXPECT_GT(v, 0);
}

}  // namespace
}  // namespace covtrace
