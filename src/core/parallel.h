/// Parallel loops over oneTBB. Results must not depend on which thread runs what.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace covtrace {

/// Limits the worker threads of every parallel loop while it lives; 0: all cores.
class ThreadLimit {
  public:
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;
    int threads() const;
    /// Number of threads that loops may use now.
    static int current();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Calls body(i) for all i in [0, count), each once; the order is unspecified. An exception thrown
/// by a body ends the loop and is thrown to the caller.
void parallel_for(int64_t count, const std::function<void(int64_t)>& body);

/// The same for the rows [0, height) of an image: body(first, end) for ranges of them that have
/// enough pixels, one row or more, so that narrow images do not make a task of every one.
void parallel_for_row_ranges(int width, int height, const std::function<void(int, int)>& body);

/// Calls body(y) for all rows, in such ranges.
template <typename Body>
void parallel_for_rows(int width, int height, const Body& body) {
    parallel_for_row_ranges(width, height, [&](int first, int end) {
        for (int y = first; y < end; ++y) body(y);
    });
}

}  // namespace covtrace
