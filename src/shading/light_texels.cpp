#include "shading/light_texels.h"

#include <algorithm>

#include "image/color_encoding.h"
#include "image/raster.h"

namespace covtrace {

LightTexels read_light_texels(const std::filesystem::path& file, LightChannels channels,
                              float brightest, const SourceLocation& where, Warnings& warnings) {
    const RasterImage raster = read_raster(file, where);
    const ColourSpace space = channels == LightChannels::colour
                                  ? colour_space_of(raster, file, where, warnings)
                                  : ColourSpace::srgb;
    const bool encoded = raster.is_8bit || raster.is_16bit;
    const auto linear = [&](size_t i) {
        return encoded ? srgb_decode(raster.values[i]) : raster.values[i];
    };
    const auto cut = [brightest](float v) { return v > 0 ? std::min(v, brightest) : 0.0f; };
    const auto count = static_cast<size_t>(raster.channels);
    LightTexels result{raster.width, raster.height, {}};
    result.values.resize(static_cast<size_t>(raster.width) * static_cast<size_t>(raster.height));
    for (size_t i = 0; i < result.values.size(); ++i) {
        const size_t first = i * count;
        const Rgb c = count < 3 ? Rgb(linear(first))
                                : clipped_to_rec709(
                                      {linear(first), linear(first + 1), linear(first + 2)}, space);
        result.values[i] = {cut(c.r), cut(c.g), cut(c.b)};
    }
    return result;
}

}  // namespace covtrace
