/// Values that are no finite numbers: files must not hold them, since every filter, denoiser and
/// compositor spreads them.
#pragma once

#include <optional>
#include <string>

#include "image/image.h"

namespace covtrace {

struct ReplacedPixels {
    int pixels = 0;      ///< that had such a value in any layer
    int x = 0, y = 0;    ///< the first of them, row by row
    std::string layers;  ///< "image, raw, variance", in the order of the channels
};

/// Puts numbers in their places: the largest float for infinite values, with their sign, and the
/// mean of the finite ones among the eight neighbours for NaN, 0 where there are none. In the
/// layers "variance" and "error" NaN, too, becomes the largest float: nothing is known there.
/// Metadata that is not finite is left out. Nothing else changes. Empty where all pixels are
/// finite; else the metadata tells what was done.
std::optional<ReplacedPixels> replace_nonfinite(Image& image);

/// What the metadata of an image tell of replaced pixels.
std::optional<ReplacedPixels> replaced_pixels(const Metadata& metadata);

/// One line for people, without what goes before it.
std::string describe(const ReplacedPixels& replaced);

}  // namespace covtrace
