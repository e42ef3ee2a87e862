/// Images in the format that their files' names say.
#pragma once

#include <filesystem>
#include <optional>

#include "image/display.h"
#include "image/image.h"

namespace covtrace {

/// Formats of images. OpenEXR has all layers and metadata; the others hold the colour of the data
/// window alone: PNG for display, PFM as it is, Radiance HDR with 8 bits and a common exponent.
enum class WrittenFormat { exr, png, pfm, hdr };

/// The format that a name's ending says: .exr, .png, .pfm or .hdr, in capitals or not; OpenEXR for
/// names without an ending, as of /dev/stdout. None for any other ending.
std::optional<WrittenFormat> written_format(const std::filesystem::path& file);

/// Text of a message about a name with another ending, to follow the name.
inline constexpr const char* kExpectedImageName =
    "names no format that is written; expected a name that ends in .exr (OpenEXR, with layers), "
    ".png, .pfm or .hdr (the colour alone)";

/// Writes an image as write_exr, write_png, write_pfm or write_hdr do, by the file's name.
/// `display` is that of a PNG; the others hold linear values as they are. Throws Error(usage) where
/// the name says no format that is written, otherwise as those functions.
void write_image(const Image& image, const std::filesystem::path& file, int threads = 1,
                 const DisplayOptions& display = {});

/// Writes 32-bit floats, bit by bit: the root channels R, G, B, or Y as a grey image. Written
/// beside and renamed. Throws Error(io); Error(internal) for an image without these channels.
void write_pfm(const Image& image, const std::filesystem::path& file);

/// Writes Radiance RGBE with run lengths: the root channels R, G, B, or Y; 0 for negative values
/// and NaN, the largest value of the format for larger ones. Colours are within 0.4 % of their
/// largest component. Written beside and renamed. Throws as write_pfm.
void write_hdr(const Image& image, const std::filesystem::path& file);

}  // namespace covtrace
