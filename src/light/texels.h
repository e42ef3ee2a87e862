/// The image of a light as radiances.
#pragma once

#include <filesystem>
#include <vector>

#include "core/error.h"
#include "core/vec.h"
#include "image/raster.h"

namespace covtrace {

/// Largest value of a texel. A brighter one is damage (the radiance of the sun is below 1e10), and
/// sums of it would overflow.
inline constexpr float kBrightestTexel = 1e18f;

/// An image as it was read; its texels are decoded when they are asked for.
struct LightTexels {
    RasterImage raster;
    ColourSpace space = ColourSpace::srgb;

    int width() const { return raster.width; }
    int height() const { return raster.height; }
    size_t size() const { return size_t(width()) * size_t(height()); }
    /// The radiance of one texel, linear, row by row from the top; no channel is negative or above
    /// kBrightestTexel.
    Rgb operator[](size_t texel) const;
    std::vector<Rgb> all() const;
};

/// How the channels of a light's image are read.
enum class LightChannels {
    colour,  ///< as a colour, linear Rec.709, from the colour space that the file names
    factors  ///< as plain numbers
};

/// Reads the image of a light. Integers are decoded from sRGB, as in pbrt-v4. Throws Error(scene)
/// at `where` for files that can't be read, Error(limit) for those too large; warns where a file's
/// colour space is not known.
LightTexels read_light_texels(const std::filesystem::path& file, LightChannels channels,
                              const SourceLocation& where, Warnings& warnings);

}  // namespace covtrace
