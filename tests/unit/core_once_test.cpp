// Work on demand inside of parallel loops: done once, seen by all.
#include "core/once.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

#include "core/parallel.h"

namespace covtrace {
namespace {

TEST(Once, IsDoneOnceAndSeenByAll) {
    for (int repeat = 0; repeat < 20; ++repeat) {
        const Once once;
        std::atomic<int> calls = 0, wrong = 0;
        int64_t result = 0;
        parallel_for(64, [&](int64_t) {
            once([&] {
                ++calls;
                // The loop is one of its own: threads that wait must not start the outer one's
                // bodies in it.
                std::atomic<int64_t> sum = 0;
                parallel_for(1000, [&](int64_t i) { sum += i; });
                result = sum;
            });
            if (result != 499500) ++wrong;
        });
        EXPECT_EQ(calls, 1);
        EXPECT_EQ(wrong, 0);
    }
}

TEST(Once, IsTriedAgainAfterAnException) {
    const Once once;
    EXPECT_THROW(once([] { throw std::runtime_error("no memory"); }), std::runtime_error);
    bool done = false;
    once([&] { done = true; });
    EXPECT_TRUE(done);
    once([&] { done = false; });
    EXPECT_TRUE(done);
}

}  // namespace
}  // namespace covtrace
