/// Checks of the names of output files, whose endings say their format.
#pragma once

#include <filesystem>
#include <string>

#include "image/layer_selection.h"

namespace covtrace::cli {

/// Checks the name of an image. Throws Error(usage), whose message begins with `option`, for an
/// ending that is none of the formats that are written, or one of a format that cannot hold the
/// layers that were asked for by name. Empty names pass.
void require_image_name(const std::string& option, const std::filesystem::path& file,
                        const LayerSelection& layers);

/// Checks the name of a PNG file. Throws Error(usage), whose message begins with `option`, for an
/// ending other than .png; names without an ending, and empty ones, pass.
void require_picture_name(const std::string& option, const std::filesystem::path& file);

/// Checks the name of an HTML page. Throws Error(usage), whose message begins with `option`, for an
/// ending of any image format that is written or read; all others pass.
void require_report_name(const std::string& option, const std::filesystem::path& file);

}  // namespace covtrace::cli
