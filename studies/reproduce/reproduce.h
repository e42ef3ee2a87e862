/// Runs experiments and writes the page.
#pragma once

#include <string>
#include <vector>

#include "reproduce/experiment.h"

namespace covtrace::reproduce {

struct Outcome {
    int failed = 0;             ///< experiments that could not be run
    std::string first_failure;  ///< reason for the first of them
    ErrorKind kind = ErrorKind::internal;
    bool interrupted = false;
    int claims = 0, held = 0;  ///< claims that are judged, and those of them that hold
};

/// Runs the experiments of these names, all where there is none, in the order of the page, and
/// writes index.html, results.json and figures/ into the workshop's output after each of them. An
/// experiment that can't be run says so in the page; the others run. `command` is shown in the
/// page.
///
/// Throws Error(usage) for an unknown name, Error(io) where the output cannot be written.
Outcome reproduce(Workshop& workshop, const std::vector<std::string>& names,
                  const std::string& command);

}  // namespace covtrace::reproduce
