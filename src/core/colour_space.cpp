#include "core/colour_space.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace covtrace {

namespace {

using Matrix3 = std::array<std::array<float, 3>, 3>;

// Matrices to Rec.709, from the primaries and white points of ITU-R BT.2020, SMPTE EG 432-1 (P3
// with D65) and SMPTE ST 2065-1.
constexpr Matrix3 kFromP3{{{1.2249402f, -0.2249402f, 0.0f},
                           {-0.0420570f, 1.0420570f, 0.0f},
                           {-0.0196376f, -0.0786360f, 1.0982736f}}};
constexpr Matrix3 kFromRec2020{{{1.6604910f, -0.5876411f, -0.0728499f},
                                {-0.1245505f, 1.1328999f, -0.0083494f},
                                {-0.0181508f, -0.1005789f, 1.1187297f}}};
constexpr Matrix3 kFromAces{{{2.5216862f, -1.1341310f, -0.3875552f},
                             {-0.2764799f, 1.3727191f, -0.0962392f},
                             {-0.0153781f, -0.1529753f, 1.1683534f}}};

// Chromaticities of the spaces by the standards above; the white of D60 is SMPTE ST 2065-1's.
struct Definition {
    ColourSpace space;
    Chromaticities chromaticities;
};
constexpr std::array<Definition, 4> kDefinitions{{
    {ColourSpace::srgb, {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f}},
    {ColourSpace::dci_p3, {0.68f, 0.32f, 0.265f, 0.69f, 0.15f, 0.06f, 0.3127f, 0.329f}},
    {ColourSpace::rec2020, {0.708f, 0.292f, 0.17f, 0.797f, 0.131f, 0.046f, 0.3127f, 0.329f}},
    {ColourSpace::aces2065_1, {0.7347f, 0.2653f, 0, 1, 0.0001f, -0.077f, 0.32168f, 0.33767f}},
}};

bool is_close(float value, float expected) {
    return std::abs(value - expected) <= std::max(1e-3f * std::abs(expected), 1e-4f);
}

Rgb product(const Matrix3& m, Rgb c) {
    return {m[0][0] * c.r + m[0][1] * c.g + m[0][2] * c.b,
            m[1][0] * c.r + m[1][1] * c.g + m[1][2] * c.b,
            m[2][0] * c.r + m[2][1] * c.g + m[2][2] * c.b};
}

}  // namespace

std::optional<ColourSpace> colour_space_named(std::string_view given) {
    std::string name(given);
    for (char& c : name)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (name == "srgb") return ColourSpace::srgb;
    if (name == "dci-p3") return ColourSpace::dci_p3;
    if (name == "rec2020") return ColourSpace::rec2020;
    if (name == "aces2065-1") return ColourSpace::aces2065_1;
    return std::nullopt;
}

const std::vector<std::string>& colour_space_names() {
    static const std::vector<std::string> names{"srgb", "dci-p3", "rec2020", "aces2065-1"};
    return names;
}

std::optional<ColourSpace> colour_space_with(const Chromaticities& c) {
    for (const Definition& d : kDefinitions)
        if (std::equal(c.begin(), c.end(), d.chromaticities.begin(), is_close)) return d.space;
    return std::nullopt;
}

Rgb to_rec709(Rgb c, ColourSpace from) {
    switch (from) {
        case ColourSpace::srgb:
            return c;
        case ColourSpace::dci_p3:
            return product(kFromP3, c);
        case ColourSpace::rec2020:
            return product(kFromRec2020, c);
        case ColourSpace::aces2065_1:
            return product(kFromAces, c);
    }
    return c;
}

Rgb clipped_to_rec709(Rgb c, ColourSpace from) {
    if (from == ColourSpace::srgb) return c;
    const Rgb r = to_rec709(c, from);
    return {std::max(0.0f, r.r), std::max(0.0f, r.g), std::max(0.0f, r.b)};
}

}  // namespace covtrace
