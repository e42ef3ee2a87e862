#include "image/darkness.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "image/color_encoding.h"

namespace covtrace {

namespace {

using Channels = std::array<const Channel*, 3>;

/// The three channels of a layer, given with its dot; none where one is missing.
Channels layer(const Image& image, const std::string& name) {
    const Channels found{image.find(name + "R"), image.find(name + "G"), image.find(name + "B")};
    return std::ranges::count(found, nullptr) == 0 ? found : Channels{};
}

float luminance_at(const Channels& c, size_t pixel) {
    return luminance(Rgb(c[0]->values[pixel], c[1]->values[pixel], c[2]->values[pixel]));
}

}  // namespace

double dark_share(const Image& image) {
    constexpr float kBlack = 0.02f;  // albedo of surfaces that are dark in any light
    const float step = srgb_decode(1.0f / 255);
    const Channels light = layer(image, ""), albedo = layer(image, "albedo.");
    if (!light[0] || !albedo[0]) return 0;
    // A dim room is no room without light: filters leave traces, the mean of the samples none.
    const Channels raw = layer(image, "raw."), met = raw[0] ? raw : light;
    size_t surfaces = 0, dark = 0;
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const float reflected = luminance_at(albedo, i);
        if (!(reflected > kBlack)) continue;
        ++surfaces;
        dark += luminance_at(light, i) < step * reflected && !(luminance_at(met, i) > 0);
    }
    return surfaces == 0 ? 0 : double(dark) / double(surfaces);
}

}  // namespace covtrace
