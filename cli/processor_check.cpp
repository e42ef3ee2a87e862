// The check of the processor: ends the program with a message where the processor lacks
// instructions that it was compiled for; the first of them would end it by SIGILL without a word.
// This file and core/processor.cpp are compiled for any x86-64.
#include <unistd.h>

#include <cstring>

#include "cli/failure.h"
#include "core/processor.h"

namespace {

void write_error(const char* text) {
    // A message that cannot be written is lost: nothing is left to do, and the exit code tells.
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text, std::strlen(text));
}

/// Runs before the initialisers of all other files, which may use instructions that are missing:
/// 101 is the first priority that is free for programs.
[[gnu::constructor(101)]] void refuse_other_processors() {
    const char* missing = covtrace::missing_instructions();
    if (!missing) return;
    write_error("covtrace: ");
    write_error(missing);
    write_error("\n");
    ::_exit(covtrace::cli::kLimitExitCode);
}

}  // namespace
