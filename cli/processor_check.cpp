// Ends the program with a message where the processor lacks instructions that it was compiled for,
// which would otherwise end it by a signal. Compiled, as core/processor.cpp, for any x86-64.
#include <unistd.h>

#include <cstring>

#include "cli/failure.h"
#include "core/processor.h"

namespace {

void write_error(const char* text) {
    // Nothing can be done where the message cannot be written; the exit code tells as well.
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text, std::strlen(text));
}

/// 101 is the first priority that is free for programs: it runs before the initialisers of all
/// other files, which may have these instructions.
[[gnu::constructor(101)]] void refuse_other_processors() {
    const char* missing = covtrace::missing_instructions();
    if (!missing) return;
    write_error("covtrace: ");
    write_error(missing);
    write_error("\n");
    ::_exit(covtrace::cli::kLimitExitCode);
}

}  // namespace
