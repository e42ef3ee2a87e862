/// Parsers for the values of command-line options. Each throws Error(usage), whose message begins
/// with `option`, for any other text.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "image/image.h"
#include "render/overrides.h"
#include "render/shard.h"

namespace covtrace::cli {

/// Reads a duration above zero in seconds: "2.5", "45s", "3m", "1h30m".
double parse_duration(const std::string& option, const std::string& text);
/// Reads a resolution: "640x360".
std::array<int, 2> parse_resolution(const std::string& option, const std::string& text);
/// Reads a crop "x0,y0,x1,y1" in pixels, end exclusive.
PixelBounds parse_crop(const std::string& option, const std::string& text);
/// Reads a pixel "x,y".
std::array<int, 2> parse_pixel(const std::string& option, const std::string& text);
/// Reads an interval "a,b", two finite numbers with a < b.
std::array<float, 2> parse_interval(const std::string& option, const std::string& text);
/// Reads an address into host and port: "host:port", "[::1]:port", or a host alone, which gets
/// tev's own port 14158.
std::array<std::string, 2> parse_address(const std::string& option, const std::string& text);
/// Reads a finite number above zero and up to `most`; where `least` is given, not below it.
double parse_positive(const std::string& option, const std::string& text, double most,
                      double least = 0);
/// Reads a whole number in [least, most]. It is decimal: a 0 in front does not make it octal.
int64_t parse_whole(const std::string& option, const std::string& text, int64_t least,
                    int64_t most);
/// Reads the number of paths per pixel: a whole number from 1 to 2^20, or a fraction above 0, the
/// part of the pixels that get one path.
double parse_paths(const std::string& option, const std::string& text);
/// Reads a size in bytes: "500M", "2G", "64k", "1.5T" (powers of 1024) or a plain number.
size_t parse_size(const std::string& option, const std::string& text);
/// Whether a text is the name or number of one of the file's cameras: it does not begin, as
/// parse_camera's do, with a word such as "eye" that others follow.
bool names_camera(const std::string& text);
/// Reads a camera "eye x,y,z target x,y,z fov N up x,y,z", in any order; "up" may be missing.
CameraOverride parse_camera(const std::string& option, const std::string& text);
/// Reads a light from all around: a colour "r,g,b" or one number, or the name of a file that is
/// there.
EnvironmentOverride parse_environment(const std::string& option, const std::string& text);
/// Reads a lamp: "camera" or its place "x,y,z", then any of "power N", "radius N", "colour r,g,b".
LampDescription parse_lamp(const std::string& option, const std::string& text);
/// Reads an angle: a finite number of degrees.
float parse_degrees(const std::string& option, const std::string& text);
/// Reads a number in [least, most].
float parse_number(const std::string& option, const std::string& text, float least, float most);
/// Reads a shard "k/n" with 1 <= k <= n; the result's index begins at 0.
Shard parse_shard(const std::string& option, const std::string& text);

/// One sample of one pixel.
struct DebugPixel {
    int x = 0, y = 0;
    uint64_t sample = 0;  ///< from 0
};
/// Reads a sample: "x,y,sample".
DebugPixel parse_sample(const std::string& option, const std::string& text);
/// Reads a whole number in [0, 2^64).
uint64_t parse_seed(const std::string& option, const std::string& text);

}  // namespace covtrace::cli
