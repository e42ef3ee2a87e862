/// The exit code of an exception that ends the program, and what is said of it.
#pragma once

#include <exception>

namespace covtrace::cli {

/// Says on standard error why the program fails. Returns the exit code
/// (docs/reference/exit-codes.md).
int report_failure(const std::exception_ptr& failure);

/// The exit code of a command line that cannot be understood.
inline constexpr int kUsageExitCode = 2;
/// The exit code of Error(limit): this machine has too little, such as memory, for what was asked.
inline constexpr int kLimitExitCode = 4;

}  // namespace covtrace::cli
