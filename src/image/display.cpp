#include "image/display.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "image/color_encoding.h"

namespace covtrace {

namespace {

/// Colours beyond this are as white as can be in all views, and their squares are still finite.
constexpr float kBrightest = 1e6f;

/// The curve of John Hable, "Uncharted 2: HDR Lighting" (GDC 2010), before it is scaled to white.
float hable(float x) {
    constexpr float kShoulder = 0.15f, kLinear = 0.5f, kLinearAngle = 0.1f, kToe = 0.2f,
                    kToeNumerator = 0.02f, kToeDenominator = 0.3f;
    return (x * (kShoulder * x + kLinearAngle * kLinear) + kToe * kToeNumerator) /
               (x * (kShoulder * x + kLinear) + kToe * kToeDenominator) -
           kToeNumerator / kToeDenominator;
}

float filmic(float linear) {
    // Both numbers are Hable's: the exposure that the curve is made for, and its white.
    constexpr float kExposure = 2, kWhite = 11.2f;
    return hable(kExposure * linear) / hable(kWhite);
}

/// A matrix times a colour; row by row.
Rgb times(const std::array<std::array<float, 3>, 3>& m, Rgb c) {
    const auto row = [&](size_t i) { return m[i][0] * c.r + m[i][1] * c.g + m[i][2] * c.b; };
    return {row(0), row(1), row(2)};
}

/// Troy Sobotka's AgX (2022) by the numbers of Benjamin Wrensch, "Minimal AgX Implementation"
/// (2023): primaries moved inwards, the logarithm over 16.5 stops, a sigmoid (here its polynomial,
/// which differs by less than 0.006 from it), primaries moved back. The result is encoded for a
/// display already.
Rgb agx(Rgb linear) {
    constexpr std::array<std::array<float, 3>, 3> kInset{
        {{0.842479062253094f, 0.0784335999999992f, 0.0792237451477643f},
         {0.0423282422610123f, 0.878468636469772f, 0.0791661274605434f},
         {0.0423756549057051f, 0.0784336f, 0.879142973793104f}}};
    constexpr std::array<std::array<float, 3>, 3> kOutset{
        {{1.19687900512017f, -0.0980208811401368f, -0.0990297440797205f},
         {-0.0528968517574562f, 1.15190312990417f, -0.0989611768448433f},
         {-0.0529716355144438f, -0.0980434501171241f, 1.15107367264116f}}};
    constexpr float kLeast = -12.47393f, kMost = 4.026069f;  // stops from 1
    const auto curve = [=](float v) {
        const float stops = std::clamp(std::log2(v), kLeast, kMost);
        const float x = (stops - kLeast) / (kMost - kLeast);
        return -0.00232f +
               x * (0.1191f +
                    x * (0.4298f + x * (-6.868f + x * (31.96f + x * (-40.14f + x * 15.5f)))));
    };
    const Rgb inset = times(kInset, linear);
    return times(kOutset, {curve(inset.r), curve(inset.g), curve(inset.b)});
}

/// NaN is 0.
uint8_t to_8bit(float encoded) {
    return uint8_t(255.0f * (encoded > 0 ? std::min(encoded, 1.0f) : 0.0f) + 0.5f);
}

std::array<uint8_t, 3> to_8bit(Rgb encoded) {
    return {to_8bit(encoded.r), to_8bit(encoded.g), to_8bit(encoded.b)};
}

void refuse_without_config(std::string_view option, const std::string& value) {
    if (!value.empty())
        throw Error(ErrorKind::usage, OptionName{option},
                    "'" + value + "' is of an OpenColorIO config, and none is given");
}

}  // namespace

DisplayOptions display_options(float exposure, const std::string& view, OcioChoice ocio) {
    DisplayOptions options{exposure};
    if (!ocio.config.empty()) {
        ocio.view = view;
        options.ocio = std::make_shared<OcioView>(ocio);
        return options;
    }
    refuse_without_config("ocio_display", ocio.display);
    refuse_without_config("ocio_look", ocio.look);
    refuse_without_config("ocio_source", ocio.source);
    if (view.empty()) return options;
    const auto named = value_named<ViewTransform>(view);
    if (!named)
        throw Error(ErrorKind::usage, OptionName{"view"},
                    "'" + view + "' is none of " + listed_names<ViewTransform>("|"));
    options.view = *named;
    return options;
}

std::array<uint8_t, 3> display_8bit(Rgb linear, const DisplayOptions& options) {
    const float gain = std::exp2(options.exposure);
    const auto exposed = [gain](float v) { return v > 0 ? std::min(v * gain, kBrightest) : 0.0f; };
    const Rgb c{exposed(linear.r), exposed(linear.g), exposed(linear.b)};
    if (options.ocio) return to_8bit(options.ocio->shown(c));
    switch (options.view) {
        case ViewTransform::srgb:
            break;
        case ViewTransform::filmic:
            return {srgb_encode_8bit(filmic(c.r)), srgb_encode_8bit(filmic(c.g)),
                    srgb_encode_8bit(filmic(c.b))};
        case ViewTransform::agx:
            return to_8bit(agx(c));
    }
    return {srgb_encode_8bit(c.r), srgb_encode_8bit(c.g), srgb_encode_8bit(c.b)};
}

int stops_too_bright(const Image& image, const DisplayOptions& options) {
    constexpr int kGoalExponent = -1;  // 0.5
    constexpr int kTooManyStops = 3;   // above 2
    const Channel *r = image.find("R"), *g = image.find("G"), *b = image.find("B");
    if (!r || !g || !b || options.ocio || options.view != ViewTransform::srgb) return 0;
    const float black = srgb_decode(1.0f / 255), gain = std::exp2(options.exposure);
    // Pixels by their stops above the goal, 0 below it
    std::array<size_t, 1 + std::numeric_limits<float>::max_exponent - kGoalExponent> by_stops{};
    size_t shown = 0;
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const float y = gain * luminance(Rgb(r->values[i], g->values[i], b->values[i]));
        if (!(y > black && std::isfinite(y))) continue;
        const float stops = std::ceil(std::log2(y)) - kGoalExponent;
        ++by_stops[static_cast<size_t>(std::max(stops, 0.0f))];
        ++shown;
    }
    if (shown == 0 || 10 * shown < image.pixel_count()) return 0;
    int middle = 0;
    for (size_t below = by_stops[0]; below <= shown / 2; below += by_stops[size_t(middle)])
        ++middle;
    return middle >= kTooManyStops ? middle : 0;
}

}  // namespace covtrace
