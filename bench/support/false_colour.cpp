#include "support/false_colour.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "image/color_encoding.h"
#include "image/image.h"

namespace covtrace {

namespace {

/// Digits and the point, 3 wide and 5 high, the top row in the highest bits.
constexpr std::array<uint16_t, 11> kGlyphs{
    0b111'101'101'101'111, 0b010'110'010'010'111, 0b111'001'111'100'111, 0b111'001'111'001'111,
    0b101'101'111'001'001, 0b111'100'111'001'111, 0b111'100'111'101'111, 0b111'001'010'010'010,
    0b111'101'111'101'111, 0b111'101'111'001'111, 0b000'000'000'000'010};
constexpr int kGlyphSize = 2;     // output pixels per dot
constexpr int kLegend = 34;       // output pixels below the panels
constexpr int kBar = 14;          // of those, the colour bar
constexpr int kGap = 6;           // between panels
constexpr int kPanelWidth = 480;  // panels are magnified until they are about this wide

struct Canvas {
    int width, height;
    std::vector<uint8_t> rgb;
    Canvas(int w, int h) : width(w), height(h), rgb(size_t(w) * size_t(h) * 3, 255) {}
    void set(int x, int y, Rgb c) {
        if (x < 0 || y < 0 || x >= width || y >= height) return;
        for (int k = 0; k < 3; ++k)
            rgb[(size_t(y) * size_t(width) + size_t(x)) * 3 + size_t(k)] =
                uint8_t(std::lround(255 * srgb_encode(clamp01(c[k]))));
    }
    void write(int x, int y, const std::string& text) {
        for (const char ch : text) {
            const uint16_t glyph = kGlyphs[ch == '.' ? 10 : size_t(ch - '0')];
            for (int j = 0; j < 5 * kGlyphSize; ++j)
                for (int i = 0; i < 3 * kGlyphSize; ++i)
                    if (glyph >> (14 - 3 * (j / kGlyphSize) - i / kGlyphSize) & 1)
                        set(x + i, y + j, Rgb(0));
            x += 4 * kGlyphSize;
        }
    }
};

}  // namespace

Rgb LogColours::operator()(float value) const {
    if (!(value > stops.front().value)) return stops.front().colour;
    for (size_t i = 1; i < stops.size(); ++i) {
        const Stop &a = stops[i - 1], &b = stops[i];
        if (value >= b.value) continue;
        const float f = std::log(value / a.value) / std::log(b.value / a.value);
        return (1 - f) * a.colour + f * b.colour;
    }
    return stops.back().colour;
}

void PanelPicture::write_png(const std::filesystem::path& file) const {
    const int magnify = std::max(1, (kPanelWidth + width_ / 2) / width_);
    const int w = width_ * magnify, h = height_ * magnify;
    Canvas canvas(int(panels_.size()) * (w + kGap) - kGap, h + kLegend);
    int left = 0;
    for (const Panel& panel : panels_) {
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x)
                canvas.set(
                    left + x, y,
                    panel.colours[size_t(y / magnify) * size_t(width_) + size_t(x / magnify)]);
        if (!panel.ticks.empty()) {
            const float low = std::log(panel.scale.stops.front().value);
            const float high = std::log(panel.scale.stops.back().value);
            for (int x = 0; x < w; ++x)
                for (int y = 2; y < kBar; ++y)
                    canvas.set(left + x, h + y,
                               panel.scale(std::exp(low + (high - low) * float(x) / float(w - 1))));
            for (const float tick : panel.ticks) {
                const std::string text = fmt::format("{:g}", tick);
                const int half = int(text.size()) * 2 * kGlyphSize;
                const int x = int((std::log(tick) - low) / (high - low) * float(w - 1));
                for (int y = kBar; y < kBar + 4; ++y) canvas.set(left + x, h + y, Rgb(0));
                canvas.write(left + std::clamp(x - half, 0, w - 2 * half), h + kBar + 6, text);
            }
        }
        left += w + kGap;
    }
    write_png_rgb8(canvas.rgb, canvas.width, canvas.height, file);
}

}  // namespace covtrace
