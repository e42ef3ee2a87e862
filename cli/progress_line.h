/// Progress on standard error: one line that is redrawn on a terminal, plain lines elsewhere.
#pragma once

#include <functional>
#include <string>

#include "render/progress.h"

namespace covtrace::cli {

enum class ProgressStyle { automatic, bar, plain, percent, json, none };

/// A reporter for Monitor and the seconds between two reports.
struct ProgressReporter {
    std::function<void(const Progress&)> report;
    double interval = 0.1;
};
ProgressReporter make_reporter(ProgressStyle style);
/// Ends a line that `bar` keeps open.
void finish_line(ProgressStyle style);

}  // namespace covtrace::cli
