/// What the program says of an exception that ends it, and its exit code.
#pragma once

#include <exception>

namespace covtrace::cli {

/// Says on standard error what went wrong. Returns the exit code (docs/reference/exit-codes.md).
int report_failure(const std::exception_ptr& failure);

/// The exit code of a command line that cannot be understood.
inline constexpr int kUsageExitCode = 2;
/// The exit code where this machine does not suffice.
inline constexpr int kLimitExitCode = 4;

}  // namespace covtrace::cli
