/// Ctrl-C and SIGTERM while renders run.
#pragma once

#include <atomic>

namespace covtrace::cli {

/// While it lives either signal sets the flag; a second one ends the process at once. One at a
/// time.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    static const std::atomic<bool>& flag();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
};

}  // namespace covtrace::cli
