/// Values that are no finite numbers: files must not hold them, since every filter, denoiser and
/// compositor spreads them.
#pragma once

#include <optional>
#include <string>

#include "image/image.h"

namespace covtrace {

struct ReplacedPixels {
    int pixels = 0;      ///< number of pixels with such a value in any layer
    int x = 0, y = 0;    ///< the first of these pixels, row by row
    std::string layers;  ///< "image, raw, variance", in the order of the channels
};

/// Replaces values that are no finite numbers: infinite ones by the largest float, with their sign;
/// NaN by the mean of the finite ones among the eight neighbours, 0 where there are none. In the
/// layers "variance" and "error" NaN, too, becomes the largest float: nothing is known there.
/// Metadata that is not finite is left out. Nothing else changes. Empty where all pixels are
/// finite; else the metadata tells what was done.
std::optional<ReplacedPixels> replace_nonfinite(Image& image);

/// The record of replaced pixels in an image's metadata; empty where there is none.
std::optional<ReplacedPixels> replaced_pixels(const Metadata& metadata);

/// One line of text for people, to follow a prefix such as "warning: ".
std::string describe(const ReplacedPixels& replaced);

}  // namespace covtrace
