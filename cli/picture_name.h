/// Checks of the names of images, which say their format.
#pragma once

#include <filesystem>
#include <string>

#include "cli/layer_selection.h"

namespace covtrace::cli {

/// Throws Error(usage), whose message begins with `option`, for a name that says none of the
/// formats that are written, or one that cannot hold layers that were asked for by name. Empty
/// names pass.
void require_image_name(const std::string& option, const std::filesystem::path& file,
                        const LayerSelection& layers);

/// Throws such an error for a name that says another format than PNG; a name without an ending
/// passes.
void require_picture_name(const std::string& option, const std::filesystem::path& file);

/// Throws such an error for the name of a page that says the format of an image.
void require_report_name(const std::string& option, const std::filesystem::path& file);

}  // namespace covtrace::cli
