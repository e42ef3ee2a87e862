#include "light/texels.h"

#include <algorithm>
#include <utility>

#include "image/color_encoding.h"

namespace covtrace {

Rgb LightTexels::operator[](size_t texel) const {
    const bool encoded = raster.is_8bit || raster.is_16bit;
    const auto linear = [&](size_t i) {
        return encoded ? srgb_decode(raster.value(i)) : raster.value(i);
    };
    // NaN fails the comparison, and is black like all that is negative.
    const auto cut = [](float v) { return v > 0 ? std::min(v, kBrightestTexel) : 0.0f; };
    const auto count = static_cast<size_t>(raster.channels);
    const size_t first = texel * count;
    const Rgb c =
        count < 3 ? Rgb(linear(first))
                  : clipped_to_rec709({linear(first), linear(first + 1), linear(first + 2)}, space);
    return {cut(c.r), cut(c.g), cut(c.b)};
}

std::vector<Rgb> LightTexels::all() const {
    std::vector<Rgb> texels(size());
    for (size_t i = 0; i < texels.size(); ++i) texels[i] = (*this)[i];
    return texels;
}

LightTexels read_light_texels(const std::filesystem::path& file, LightChannels channels,
                              const SourceLocation& where, Warnings& warnings) {
    RasterImage raster = read_raster(file, where);
    const ColourSpace space = channels == LightChannels::colour
                                  ? colour_space_of(raster, file, where, warnings)
                                  : ColourSpace::srgb;
    return {std::move(raster), space};
}

}  // namespace covtrace
