/// Pages of the viewer, as the commands write them.
#pragma once

#include <filesystem>

#include "viewer/report.h"

namespace covtrace::cli {

/// Writes the page and says on standard error which layers were left out of it.
void write_report_file(const viewer::Report& report, const std::filesystem::path& file);

}  // namespace covtrace::cli
