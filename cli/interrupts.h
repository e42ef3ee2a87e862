/// Ctrl-C and SIGTERM while something runs that can end early.
#pragma once

#include <functional>

namespace covtrace::cli {

/// While it lives either signal calls `interrupt`, which must be safe in a signal handler and tells
/// whether it was the first call; after that a signal ends the process at once. One at a time.
class InterruptGuard {
  public:
    explicit InterruptGuard(std::function<bool()> interrupt);
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
};

}  // namespace covtrace::cli
