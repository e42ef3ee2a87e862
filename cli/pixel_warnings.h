/// Warnings of samples and pixels that are no finite numbers.
#pragma once

#include "image/image.h"
#include "render/session.h"

namespace covtrace::cli {

/// Warns of samples that count as black, and how to look at one.
void warn_of_rejected(const RenderStatistics& statistics);
/// Warns where light does not reach most of what an image shows, of which the share `dark` is dark.
void warn_of_darkness(double dark);
/// Warns of pixels that were replaced when the image was made.
void warn_of_replaced(const Image& image);

}  // namespace covtrace::cli
