/// Work that is done when its result is first needed, by whichever thread comes first.
#pragma once

#include <atomic>
#include <functional>
#include <memory>

namespace covtrace {

/// Runs work once. Threads that come while the work is under way help with its parallel loops, if
/// they have nothing else to do, and wait for its end; so it may be asked for inside of parallel
/// loops. Work that threw is tried again by the next thread.
class Once {
  public:
    Once();
    ~Once();
    Once(const Once&) = delete;
    Once& operator=(const Once&) = delete;
    /// Returns when `work` has been done once, by this call or another one.
    template <typename Work>
    void operator()(const Work& work) const {
        if (!done_.load(std::memory_order_acquire)) call(work);
    }

  private:
    void call(const std::function<void()>& work) const;

    struct Impl;
    mutable std::atomic<bool> done_ = false;
    std::unique_ptr<Impl> impl_;
};

}  // namespace covtrace
