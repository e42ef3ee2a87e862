#include "core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>

#ifdef COVTRACE_TELL_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace covtrace {
namespace {

// Order of threads, as told to the thread sanitizer: all that a thread did before `release`
// happened before anything that others do after `acquire` of the same address. oneTBB sees to that;
// the sanitizer does not see into it and has to be told. This file is not instrumented itself:
// oneTBB's templates would be, but not the library that orders their work.
#ifdef COVTRACE_TELL_THREAD_SANITIZER
void release(void* address) {
    __tsan_release(address);
}
void acquire(void* address) {
    __tsan_acquire(address);
}
#else
void release(void*) {}
void acquire(void*) {}
#endif

}  // namespace

struct ThreadLimit::Impl {
    explicit Impl(int n)
        : count(n), control(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(n)) {}
    int count;
    tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads)
    : impl_(std::make_unique<Impl>(threads > 0 ? threads : tbb::info::default_concurrency())) {}
ThreadLimit::~ThreadLimit() = default;
int ThreadLimit::threads() const {
    return impl_->count;
}
int ThreadLimit::current() {
    return static_cast<int>(
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallel_for(int64_t count, const std::function<void(int64_t)>& body) {
    // The loop gets a context of its own: without one it would run with the floating-point mode in
    // which the process first used oneTBB, and Embree does that with denormal numbers flushed to
    // zero.
    tbb::task_group_context as_the_caller(
        tbb::task_group_context::bound,
        tbb::task_group_context::default_traits | tbb::task_group_context::fp_settings);
    char begun = 0, done = 0;
    release(&begun);
    tbb::parallel_for(
        tbb::blocked_range<int64_t>(0, count, 1),
        [&](const tbb::blocked_range<int64_t>& range) {
            acquire(&begun);
            for (int64_t i = range.begin(); i != range.end(); ++i) body(i);
            release(&done);
        },
        tbb::simple_partitioner{}, as_the_caller);
    acquire(&done);
}

void parallel_for_row_ranges(int width, int height, const std::function<void(int, int)>& body) {
    // A task costs as much as some hundred of the cheapest pixels.
    constexpr int64_t kLeastPixels = 256;
    const int64_t rows = std::max<int64_t>(1, kLeastPixels / std::max(1, width));
    parallel_for((height + rows - 1) / rows, [&](int64_t i) {
        body(int(i * rows), int(std::min<int64_t>(height, (i + 1) * rows)));
    });
}

}  // namespace covtrace
