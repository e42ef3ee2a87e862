/// Options of how pictures show an image.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "image/display.h"

namespace covtrace::cli {

struct DisplayArguments {
    float exposure = 0;
    std::string view;
    OcioChoice ocio;
    DisplayOptions options;  ///< what the others come to, once they are resolved
};

/// Adds --exposure, --view and --ocio-…; `arguments` must outlive the parser.
void add_display_options(CLI::App* command, DisplayArguments& arguments);

/// Reads the config, before the work whose result it is to show. Throws as display_options.
void resolve(DisplayArguments& arguments);

/// Adds the files that were read for the picture, which no output may replace.
void add_inputs(const DisplayOptions& options, std::vector<std::filesystem::path>& inputs);

/// Warns of what in the config is not understood.
void warn_of_config(const DisplayOptions& options);

/// Warns where they are given and no PNG is written, which they are for.
void warn_of_no_picture(const DisplayOptions& options, const std::filesystem::path& image,
                        const std::string& png);

}  // namespace covtrace::cli
