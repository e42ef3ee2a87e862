#include "image/darkness.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "image/color_encoding.h"

namespace covtrace {

namespace {

using Channels = std::array<const Channel*, 3>;

/// The three channels of a layer, given with its dot; none where one is missing.
Channels layer(const Image& image, const std::string& name, const char (&letters)[4] = "RGB") {
    const Channels found{image.find(name + letters[0]), image.find(name + letters[1]),
                         image.find(name + letters[2])};
    return std::ranges::count(found, nullptr) == 0 ? found : Channels{};
}

float luminance_at(const Channels& c, size_t pixel) {
    return luminance(Rgb(c[0]->values[pixel], c[1]->values[pixel], c[2]->values[pixel]));
}

/// Whether a sample in the pixel's block met light, by pixel. A dim room is no room without light:
/// filters leave traces where there is none, the mean of the samples does not. A single pixel may
/// miss the light of a bright room.
std::vector<bool> light_is_met(const Image& image, const Channels& first_layer) {
    constexpr size_t kBlock = 16;  // pixels in x and in y
    const Channels raw = layer(image, "raw."), &samples = raw[0] ? raw : first_layer;
    const auto width = size_t(image.width());
    const size_t blocks = (width + kBlock - 1) / kBlock;
    const auto block = [&](size_t i) { return i / width / kBlock * blocks + i % width / kBlock; };
    std::vector<bool> by_block(block(image.pixel_count() - 1) + 1), met(image.pixel_count());
    for (size_t i = 0; i < met.size(); ++i)
        if (luminance_at(samples, i) > 0) by_block[block(i)] = true;
    for (size_t i = 0; i < met.size(); ++i) met[i] = by_block[block(i)];
    return met;
}

}  // namespace

double dark_share(const Image& image) {
    constexpr float kBlack = 0.02f;  // albedo of surfaces that are dark in any light
    const float step = srgb_decode(1.0f / 255);
    const Channels light = layer(image, ""), albedo = layer(image, "albedo.");
    if (!light[0] || !albedo[0]) return 0;
    const std::vector<bool> is_met = light_is_met(image, light);
    size_t surfaces = 0, dark = 0;
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const float reflected = luminance_at(albedo, i);
        if (!(reflected > kBlack)) continue;
        ++surfaces;
        dark += luminance_at(light, i) < step * reflected && !is_met[i];
    }
    return surfaces == 0 ? 0 : double(dark) / double(surfaces);
}

bool shows_nothing(const Image& image) {
    if (!(image.data == image.display)) return false;
    const Channels light = layer(image, ""), normal = layer(image, "N.", "XYZ");
    if (!light[0] || !normal[0]) return false;
    const auto is_zero = [](const Channel* c) {
        return std::ranges::all_of(c->values, [](float v) { return v == 0; });
    };
    return std::ranges::all_of(light, is_zero) && std::ranges::all_of(normal, is_zero);
}

}  // namespace covtrace
