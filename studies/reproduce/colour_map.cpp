#include "reproduce/colour_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "reproduce/stroke_font.h"

namespace covtrace::reproduce {

namespace {

constexpr std::array<Ink, 6> kStops{Ink{22, 14, 62},   Ink{38, 62, 132},  Ink{24, 118, 142},
                                    Ink{46, 164, 112}, Ink{154, 206, 62}, Ink{252, 236, 120}};

Ink colour_at(float f) {
    const float at = std::clamp(f, 0.0f, 1.0f) * float(kStops.size() - 1);
    const auto i = std::min(size_t(at), kStops.size() - 2);
    const float t = at - float(i);
    const auto mix = [t](uint8_t a, uint8_t b) {
        return uint8_t(std::lround(float(a) + t * (float(b) - float(a))));
    };
    const Ink &a = kStops[i], &b = kStops[i + 1];
    return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

}  // namespace

Ink ColourMap::operator()(float value) const {
    if (!(value > least)) return colour_at(0);
    return colour_at(std::log(value / least) / std::log(most / least));
}

ColourMap map_for(std::span<const float> values, std::string quantity) {
    std::vector<float> positive;
    for (const float v : values)
        if (v > 0 && std::isfinite(v)) positive.push_back(v);
    if (positive.empty()) return {0.1f, 10, std::move(quantity)};
    std::sort(positive.begin(), positive.end());
    const auto at = [&](double share) {
        return positive[size_t(share * double(positive.size() - 1))];
    };
    float least = at(0.02), most = at(0.98);
    if (most < 10 * least) {
        const float middle = std::sqrt(least * most), half = std::sqrt(10.0f);
        least = middle / half;
        most = middle * half;
    }
    return {least, most, std::move(quantity)};
}

Picture coloured(std::span<const float> values, int width, int height, const ColourMap& map) {
    Picture p(width, height);
    for (size_t i = 0; i < values.size(); ++i) {
        const Ink c = map(values[i]);
        p.rgb[3 * i] = c.r;
        p.rgb[3 * i + 1] = c.g;
        p.rgb[3 * i + 2] = c.b;
    }
    return p;
}

void draw_legend(Drawing& drawing, const ColourMap& map, float x, float y, float width) {
    constexpr int kSteps = 128;
    for (int i = 0; i < kSteps; ++i) {
        const Ink c = colour_at((float(i) + 0.5f) / kSteps);
        drawing.fill(x + width * float(i) / kSteps, y + 4, width / kSteps + 0.5f, 8, c);
    }
    const float range = std::log(map.most / map.least);
    const auto width_of = [](const std::string& text, float size) {
        return size / kCapital * kAdvance * float(letters_in(text));
    };
    constexpr float kNumber = 6, kQuantity = 6.5f, kGap = 5;
    float free_from = x;
    for (int power = -12; power <= 12; ++power)
        for (const float digit : {1.0f, 2.0f, 5.0f}) {
            const float value = digit * std::pow(10.0f, float(power));
            if (value < map.least || value > map.most) continue;
            const float at = x + width * std::log(value / map.least) / range;
            drawing.line({at, y + 12}, {at, y + 15}, kBlack, 1);
            // A number stays within the bar's ends, where a panel's neighbour begins.
            const std::string number = fmt::format("{:.4g}", value);
            const float half = 0.5f * width_of(number, kNumber);
            const float middle = std::clamp(at, x + half, std::max(x + half, x + width - half));
            if (middle - half < free_from) continue;
            free_from = middle + half + kGap;
            drawing.text(middle, y + 24, kNumber, number, kBlack, Anchor::middle);
        }
    const float shrink = std::min(1.0f, width / width_of(map.quantity, kQuantity));
    drawing.text(x + 0.5f * width, y + 35, shrink * kQuantity, map.quantity, kBlack,
                 Anchor::middle);
}

}  // namespace covtrace::reproduce
