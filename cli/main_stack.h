/// A stack for the program that is large enough, whatever the system's limit (`ulimit -s`) is.
#pragma once

#include <functional>

namespace covtrace::cli {

/// Runs `work`; returns or throws as it does. Where the limit of stacks is below Linux' usual 8
/// MiB, `work` runs in a thread with a stack of 8 MiB, and so do all threads that it starts. Throws
/// Error(limit) where there is no memory for that.
int with_large_stack(const std::function<int()>& work);

}  // namespace covtrace::cli
