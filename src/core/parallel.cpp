#include "core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

namespace covtrace {

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

void parallel_for(int64_t count, const std::function<void(int64_t)>& body) {
    tbb::parallel_for(
        tbb::blocked_range<int64_t>(0, count, 1),
        [&body](const tbb::blocked_range<int64_t>& range) {
            for (int64_t i = range.begin(); i != range.end(); ++i) body(i);
        },
        tbb::simple_partitioner{});
}

}  // namespace covtrace
