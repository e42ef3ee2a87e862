/// Options of how pictures show an image.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "image/display.h"

namespace covtrace::cli {

/// Adds --exposure and --view; `options` must outlive the parser.
void add_display_options(CLI::App* command, DisplayOptions& options);

/// Warns where they are given and no PNG is written, which they are for.
void warn_of_no_picture(const DisplayOptions& options, const std::filesystem::path& image,
                        const std::string& png);

}  // namespace covtrace::cli
