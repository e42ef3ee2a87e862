/// Ctrl-C, SIGTERM and SIGHUP while renders run.
#pragma once

#include <atomic>

namespace covtrace::cli {

/// While it lives each of the signals sets the flag; a second one, unless it is SIGHUP, ends the
/// process at once. One at a time.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    static const std::atomic<bool>& flag();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
};

}  // namespace covtrace::cli
