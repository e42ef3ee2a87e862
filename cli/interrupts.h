/// Ctrl-C and SIGTERM while a render runs.
#pragma once

#include "render/progress.h"

namespace covtrace::cli {

/// While it lives either signal cancels the monitor; a second one ends the process at once. One at
/// a time.
class InterruptGuard {
  public:
    explicit InterruptGuard(Monitor& monitor);
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
};

}  // namespace covtrace::cli
