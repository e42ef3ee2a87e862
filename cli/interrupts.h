/// Interruption by Ctrl-C, SIGTERM and SIGHUP while renders run.
#pragma once

#include <atomic>

namespace covtrace::cli {

/// Guard: while it lives each of the signals sets the flag; a second signal, unless it is SIGHUP,
/// ends the process at once. Only one guard may live at a time.
class InterruptGuard {
  public:
    InterruptGuard();
    ~InterruptGuard();
    static const std::atomic<bool>& flag();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
};

}  // namespace covtrace::cli
