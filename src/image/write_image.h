/// Images in the format that their files' names say.
#pragma once

#include <filesystem>
#include <optional>

#include "image/image.h"

namespace covtrace {

/// OpenEXR has all layers and metadata; the others hold the colour of the data window alone: PNG
/// for display, PFM as it is, Radiance HDR with 8 bits and a common exponent.
enum class WrittenFormat { exr, png, pfm, hdr };

/// By the ending .exr, .png, .pfm or .hdr, in capitals or not; OpenEXR for names without an ending,
/// as of /dev/stdout. None for any other ending.
std::optional<WrittenFormat> written_format(const std::filesystem::path& file);

/// The end of a message about a name with another ending, after the name.
inline constexpr const char* kExpectedImageName =
    "names no format that is written; expected a name that ends in .exr (OpenEXR, with layers), "
    ".png, .pfm or .hdr (the colour alone)";

/// Writes as write_exr or write_png do, or else by the functions below. Throws Error(usage) where
/// the name says no format that is written, otherwise as those.
void write_image(const Image& image, const std::filesystem::path& file, int threads = 1);

/// 32-bit floats, bit by bit: the root channels R, G, B, or Y as a grey image. Written beside and
/// renamed. Throws Error(io); Error(internal) for an image without them.
void write_pfm(const Image& image, const std::filesystem::path& file);

/// Radiance RGBE with run lengths: the root channels R, G, B, or Y; 0 for what is negative or no
/// number, the largest value of the format for what is above it. Colours are within 0.4 % of their
/// largest component. Written beside and renamed. Throws as write_pfm.
void write_hdr(const Image& image, const std::filesystem::path& file);

}  // namespace covtrace
