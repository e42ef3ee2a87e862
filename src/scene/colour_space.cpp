#include "scene/colour_space.h"

#include <array>

namespace covtrace {

namespace {

using Matrix3 = std::array<std::array<float, 3>, 3>;

// From the primaries and white points of ITU-R BT.2020, SMPTE EG 432-1 (P3 with D65) and SMPTE ST
// 2065-1.
constexpr Matrix3 kFromP3{{{1.2249402f, -0.2249402f, 0.0f},
                           {-0.0420570f, 1.0420570f, 0.0f},
                           {-0.0196376f, -0.0786360f, 1.0982736f}}};
constexpr Matrix3 kFromRec2020{{{1.6604910f, -0.5876411f, -0.0728499f},
                                {-0.1245505f, 1.1328999f, -0.0083494f},
                                {-0.0181508f, -0.1005789f, 1.1187297f}}};
constexpr Matrix3 kFromAces{{{2.5216862f, -1.1341310f, -0.3875552f},
                             {-0.2764799f, 1.3727191f, -0.0962392f},
                             {-0.0153781f, -0.1529753f, 1.1683534f}}};

Rgb product(const Matrix3& m, Rgb c) {
    return {m[0][0] * c.r + m[0][1] * c.g + m[0][2] * c.b,
            m[1][0] * c.r + m[1][1] * c.g + m[1][2] * c.b,
            m[2][0] * c.r + m[2][1] * c.g + m[2][2] * c.b};
}

}  // namespace

std::optional<ColourSpace> colour_space_named(std::string_view name) {
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

}  // namespace covtrace
