/// Images with named channels, as the renderer writes and the tools read them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/error.h"
#include "core/vec.h"

namespace covtrace {

/// A rectangle of pixels: [x0, x1) x [y0, y1).
struct PixelBounds {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    constexpr int width() const { return x1 - x0; }
    constexpr int height() const { return y1 - y0; }
    constexpr bool empty() const { return x1 <= x0 || y1 <= y0; }
    constexpr bool contains(const PixelBounds& b) const {
        return x0 <= b.x0 && y0 <= b.y0 && b.x1 <= x1 && b.y1 <= y1;
    }
    constexpr bool operator==(const PixelBounds&) const = default;
};

/// The common pixels of both; may be empty().
constexpr PixelBounds intersection(const PixelBounds& a, const PixelBounds& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

struct Channel {
    std::string name;           ///< "R", "raw.R", "cov.00" …
    std::vector<float> values;  ///< data.width() * data.height(), row by row from the top
};

using MetadataValue = std::variant<int, float, std::string, std::vector<float>>;
using Metadata = std::map<std::string, MetadataValue>;
/// Name of the metadata entry of eight floats, as Chromaticities, that EXR files keep as an
/// attribute of its own type.
inline constexpr const char* kChromaticities = "chromaticities";

struct Image {
    PixelBounds data;     ///< the pixels that are stored
    PixelBounds display;  ///< the full frame
    std::vector<Channel> channels;
    Metadata metadata;

    int width() const { return data.width(); }
    int height() const { return data.height(); }
    size_t pixel_count() const { return size_t(width()) * size_t(height()); }
    const Channel* find(std::string_view name) const;  ///< null where there is none
    Channel& add_channel(std::string name);            ///< zero-filled
    /// Colour of pixel i from the channels prefix+"R", "G", "B"; throws std::out_of_range where
    /// they are missing.
    Rgb rgb(size_t pixel, std::string_view prefix = {}) const;
};

/// A copy of the image with the pixels of `bounds` only, which must lie inside its data window. The
/// display window stays.
Image cropped(const Image& image, const PixelBounds& bounds);

/// Reads EXR, PNG, JPEG, TGA, Radiance HDR, PFM, PGM, PPM, QOI and WebP; the content decides, not
/// the file's name (but for TGA, which has no signature). All channels become float; 8- and 16-bit
/// integer colour is decoded from sRGB, alpha is not. EXR keeps its windows, metadata and channel
/// names, those of further parts prefixed with the part's name; plain images get R, G, B, A, or Y,
/// A where they are grey. NaN and infinite values are kept.
///
/// Throws Error(scene) with one line that names the file, also where an image has more than 2^28
/// pixels or would need more than 4 GiB.
Image read_image(const std::filesystem::path& file);

/// Writes 32-bit floats, ZIP-compressed scan lines, one part; values are stored bit by bit.
/// Metadata of 2 and 3 floats is written as a vector, of 9 and 16 as a matrix, of any other number
/// as a list; but kChromaticities as an attribute of that type. The file is written beside and
/// renamed (OutputFile). `threads` compress; the bytes do not depend on it.
///
/// Throws Error(io) where the file cannot be written; Error(internal) for an image that is not well
/// formed: no pixels or channels, channels of the wrong size or with the same name, metadata with a
/// name that OpenEXR keeps for itself ("version", "type", "name", "compression" …).
void write_exr(const Image& image, const std::filesystem::path& file, int threads = 1);

/// Writes an image tone-mapped for display: exposure 1, sRGB curve, clamped, 8 bits, NaN as black;
/// root channels R, G, B, or Y. Written beside and renamed. Throws Error(io).
void write_png(const Image& image, const std::filesystem::path& file);

/// The bytes of a PNG file from 8-bit display values as they are: width * height * 3 bytes, row by
/// row from the top.
std::string encode_png_rgb8(std::span<const uint8_t> rgb, int width, int height);

/// Writes 8-bit display values as a PNG file, beside and renamed. Throws Error(io).
void write_png_rgb8(std::span<const uint8_t> rgb, int width, int height,
                    const std::filesystem::path& file);

/// Describes an image in several lines for people: windows, channels by layer with the range of
/// their values and how many are not finite, metadata.
std::string describe(const Image& image);

}  // namespace covtrace
