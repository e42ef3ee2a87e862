/// Option values that need a parser of their own. All throw CLI::ValidationError, a usage error.
#pragma once

#include <array>
#include <string>

#include "image/image.h"

namespace covtrace::cli {

/// "2.5", "45s", "3m", "1h30m" in seconds; above zero.
double parse_duration(const std::string& text);
/// "640x360".
std::array<int, 2> parse_resolution(const std::string& text);
/// "x0,y0,x1,y1" in pixels, end exclusive.
PixelBounds parse_crop(const std::string& text);
/// "a,b", two numbers.
std::array<float, 2> parse_pair(const std::string& text);

}  // namespace covtrace::cli
