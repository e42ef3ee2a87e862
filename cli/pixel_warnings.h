/// Warnings of samples and pixels that are no finite numbers, and of images that show little.
#pragma once

#include <string>

#include "image/image.h"
#include "render/session.h"

namespace covtrace::cli {

/// Warns of samples that count as black, and how to look at one.
void warn_of_rejected(const RenderStatistics& statistics);
/// Warns where light does not reach most of what an image shows, of which the share `dark` is dark.
/// `has_environment`: whether --environment was given, which is no remedy then.
void warn_of_darkness(double dark, bool has_environment);
/// Warns of an image that shows nothing. `view`: view_of_all of the scene, where that is not empty.
void warn_of_nothing(const std::string& view);
/// Warns of a picture that is `stops` too bright to show half of what has light. `exposure`: by
/// which it was brightened.
void warn_of_overexposure(int stops, float exposure);
/// Warns of pixels that were replaced when the image was made.
void warn_of_replaced(const Image& image);

}  // namespace covtrace::cli
