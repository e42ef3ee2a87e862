/// Names in an EXR header that belong to the format: they describe how the pixels are stored.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace covtrace {

/// Longest name of a channel or an attribute.
inline constexpr size_t kExrNameLimit = 255;

/// The width of a pixel over its height, which an image has as metadata where it is not 1.
inline constexpr const char* kPixelAspectRatio = "pixelAspectRatio";

/// Whether an attribute is one that readers interpret with a type of their own (OpenEXR, "Standard
/// Attributes"): such ones are neither read as metadata nor written from it. "name", "type",
/// "version" and "chunkCount" are reserved for files with several parts, and OpenEXR's own reader
/// refuses them with other types.
constexpr bool is_structural_exr_name(std::string_view name) {
    constexpr std::array<std::string_view, 15> kNames = {"channels",
                                                         "chunkCount",
                                                         "compression",
                                                         "dataWindow",
                                                         "deepImageState",
                                                         "displayWindow",
                                                         "lineOrder",
                                                         "maxSamplesPerPixel",
                                                         "name",
                                                         "pixelAspectRatio",
                                                         "screenWindowCenter",
                                                         "screenWindowWidth",
                                                         "tiles",
                                                         "type",
                                                         "version"};
    return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

}  // namespace covtrace
