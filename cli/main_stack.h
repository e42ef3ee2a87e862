/// A stack that is large enough, whatever the system's limit (`ulimit -s`) is.
#pragma once

#include <functional>

namespace covtrace::cli {

/// What `work` returns or throws. Where the limit of stacks is lower than what systems usually
/// have, `work` runs in a thread that has as much as that, and so do all threads that it starts.
/// Throws Error(limit) where there is no memory for that.
int with_large_stack(const std::function<int()>& work);

}  // namespace covtrace::cli
