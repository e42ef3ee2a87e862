#include "image/darkness.h"

#include <array>
#include <cstddef>

#include "image/color_encoding.h"

namespace covtrace {

double dark_share(const Image& image) {
    constexpr float kBlack = 0.02f;  // albedo of surfaces that are dark in any light
    const float step = srgb_decode(1.0f / 255);
    constexpr std::array kNames{"R", "G", "B", "albedo.R", "albedo.G", "albedo.B"};
    std::array<const Channel*, kNames.size()> channels{};
    for (size_t k = 0; k < channels.size(); ++k)
        if (channels[k] = image.find(kNames[k]); channels[k] == nullptr) return 0;
    const auto luminance_at = [&channels](size_t first, size_t i) {
        return luminance(Rgb(channels[first]->values[i], channels[first + 1]->values[i],
                             channels[first + 2]->values[i]));
    };
    size_t surfaces = 0, dark = 0;
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const float albedo = luminance_at(3, i);
        if (!(albedo > kBlack)) continue;
        ++surfaces;
        dark += luminance_at(0, i) < step * albedo;
    }
    return surfaces == 0 ? 0 : double(dark) / double(surfaces);
}

}  // namespace covtrace
