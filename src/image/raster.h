/// Pictures as textures and environment maps use them: interleaved, with the values of the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <new>
#include <optional>
#include <string_view>
#include <vector>

#include "core/colour_space.h"
#include "core/error.h"

namespace covtrace {

struct RasterImage {
    int width = 0, height = 0;
    int channels = 0;  ///< 1 (grey), 3 (R, G, B) or 4 (R, G, B, A; A not premultiplied)
    /// Interleaved values, row by row from the top, of files with 8-bit integers.
    std::vector<uint8_t> bytes;
    std::vector<float> values;  ///< the values of other files; see read_raster
    bool is_8bit = false;       ///< 8-bit integers in the file, usually sRGB-encoded
    bool is_16bit = false;      ///< 16-bit integers in the file, usually sRGB-encoded
    /// Colour space of linear R, G, B where these are colours; empty where the file names primaries
    /// that belong to none of the known spaces. See colour_space_of.
    std::optional<ColourSpace> colour_space = ColourSpace::srgb;
    int64_t repaired = 0;  ///< values that were NaN or infinite in the file

    size_t size() const { return is_8bit ? bytes.size() : values.size(); }
    /// The i-th value as a float; integers are scaled to [0, 1].
    float value(size_t i) const { return is_8bit ? float(bytes[i]) / 255.0f : values[i]; }
};

/// Reads the formats of read_image. Integers are scaled to [0, 1] and left as they are encoded,
/// palettes expanded, the alpha of grey images dropped. An EXR gives the pixels of its data window,
/// from the root layer's R, G, B, A or Y, or else from its only channel; its chromaticities tell
/// the colour space, the values are not converted. NaN becomes 0, ±Inf the largest finite magnitude
/// of the image with its sign.
///
/// Throws Error(scene) at `where` with one line that names the file, as read_image does, and
/// Error(limit) where its pixels are more than the process may hold (core/memory_limit.h).
RasterImage read_raster(const std::filesystem::path& file, const SourceLocation& where = {});
/// Reads a file in memory, which messages call `name`; PNG, JPEG and the other formats but EXR and
/// Targa.
RasterImage decode_raster(std::string_view bytes, const std::filesystem::path& name,
                          const SourceLocation& where = {});

/// The colour space of a raster whose values are used as colours: sRGB where the file's is not
/// known, with a warning at `where`, as in pbrt-v4.
ColourSpace colour_space_of(const RasterImage& raster, const std::filesystem::path& file,
                            const SourceLocation& where, Warnings& warnings);

/// Calls `make` to make something of an image file; where the system has no memory for it,
/// Error(limit) at `where` names the file.
template <typename Make>
auto made_of(const std::filesystem::path& file, const SourceLocation& where, const Make& make) {
    try {
        return make();
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::limit, where, "not enough memory for '" + file.string() + "'");
    }
}

}  // namespace covtrace
