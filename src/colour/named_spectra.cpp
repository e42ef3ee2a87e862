#include "colour/named_spectra.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace covtrace {

namespace {

constexpr size_t kSamples = 41;
constexpr float kFirst = 380, kStep = 10;

struct Metal {
    std::string_view name;
    std::array<float, kSamples> values;
};

// Optical constants of metals at 380, 390, ... 780 nm, interpolated linearly between the (mostly
// other) wavelengths of pbrt-v4's tables (src/pbrt/util/spectrum.cpp). These do not say who
// measured them.
constexpr std::array<Metal, 14> kMetals{{
    {"metal-Ag-eta",
     {{0.1986f, 0.1879f, 0.173f,  0.1728f, 0.1669f, 0.1595f, 0.1575f, 0.1517f, 0.1434f,
       0.1361f, 0.1314f, 0.1302f, 0.13f,   0.13f,   0.13f,   0.1298f, 0.1286f, 0.1248f,
       0.1212f, 0.1197f, 0.1197f, 0.121f,  0.124f,  0.1274f, 0.131f,  0.1342f, 0.1371f,
       0.1394f, 0.14f,   0.1401f, 0.14f,   0.1403f, 0.1425f, 0.1446f, 0.1464f, 0.1479f,
       0.147f,  0.146f,  0.1448f, 0.1436f, 0.1429f}}},
    {"metal-Ag-k",
     {{1.718f, 1.838f, 1.951f, 2.071f, 2.183f, 2.283f, 2.375f, 2.47f,  2.567f, 2.659f, 2.746f,
       2.83f,  2.918f, 3.01f,  3.098f, 3.178f, 3.258f, 3.34f,  3.421f, 3.501f, 3.58f,  3.657f,
       3.731f, 3.805f, 3.881f, 3.963f, 4.045f, 4.129f, 4.21f,  4.292f, 4.371f, 4.449f, 4.523f,
       4.597f, 4.671f, 4.745f, 4.821f, 4.897f, 4.975f, 5.052f, 5.131f}}},
    {"metal-Al-eta",
     {{0.4422f, 0.4661f, 0.4901f, 0.5149f, 0.5394f, 0.5644f, 0.5905f, 0.618f, 0.6463f,
       0.6749f, 0.7046f, 0.7359f, 0.7686f, 0.8028f, 0.8387f, 0.8764f, 0.916f, 0.9586f,
       1.004f,  1.049f,  1.097f,  1.148f,  1.197f,  1.248f,  1.3f,    1.357f, 1.415f,
       1.475f,  1.536f,  1.599f,  1.674f,  1.75f,   1.837f,  1.927f,  2.037f, 2.148f,
       2.27f,   2.393f,  2.49f,   2.584f,  2.665f}}},
    {"metal-Al-k",
     {{4.615f, 4.741f, 4.861f, 4.98f,  5.105f, 5.23f,  5.348f, 5.469f, 5.59f,  5.716f, 5.839f,
       5.96f,  6.078f, 6.199f, 6.323f, 6.447f, 6.562f, 6.687f, 6.807f, 6.924f, 7.036f, 7.146f,
       7.257f, 7.368f, 7.481f, 7.588f, 7.693f, 7.794f, 7.9f,   8.008f, 8.115f, 8.221f, 8.312f,
       8.403f, 8.49f,  8.572f, 8.594f, 8.617f, 8.613f, 8.604f, 8.569f}}},
    {"metal-Au-eta",
     {{1.688f,  1.671f,  1.658f,  1.641f,  1.628f,  1.61f,   1.574f,  1.508f,  1.419f,
       1.321f,  1.19f,   1.02f,   0.8512f, 0.6997f, 0.572f,  0.4729f, 0.3976f, 0.3504f,
       0.3172f, 0.2872f, 0.26f,   0.2369f, 0.2203f, 0.2061f, 0.1939f, 0.1837f, 0.1748f,
       0.1678f, 0.1639f, 0.1611f, 0.1605f, 0.1601f, 0.1605f, 0.1611f, 0.1626f, 0.1642f,
       0.1667f, 0.1691f, 0.1719f, 0.1746f, 0.1771f}}},
    {"metal-Au-k",
     {{1.918f, 1.941f, 1.956f, 1.959f, 1.952f, 1.935f, 1.911f, 1.879f, 1.843f, 1.81f,  1.796f,
       1.814f, 1.887f, 2.018f, 2.184f, 2.371f, 2.555f, 2.714f, 2.837f, 2.91f,  2.948f, 2.969f,
       3.0f,   3.03f,  3.06f,  3.066f, 3.09f,  3.138f, 3.275f, 3.443f, 3.633f, 3.818f, 3.964f,
       4.107f, 4.237f, 4.365f, 4.479f, 4.594f, 4.701f, 4.808f, 4.914f}}},
    {"metal-Cu-eta",
     {{1.206f,  1.178f,  1.175f,  1.179f,  1.178f,  1.174f,  1.171f,  1.166f,  1.16f,
       1.154f,  1.148f,  1.14f,   1.134f,  1.127f,  1.111f,  1.081f,  1.033f,  0.9582f,
       0.8614f, 0.7376f, 0.6027f, 0.4732f, 0.3902f, 0.324f,  0.2718f, 0.2459f, 0.2266f,
       0.2166f, 0.212f,  0.2093f, 0.2112f, 0.2132f, 0.2148f, 0.2167f, 0.22f,   0.2234f,
       0.2295f, 0.2356f, 0.2414f, 0.2472f, 0.2509f}}},
    {"metal-Cu-k",
     {{2.094f, 2.196f, 2.13f,  2.186f, 2.248f, 2.301f, 2.349f, 2.394f, 2.436f, 2.477f, 2.515f,
       2.547f, 2.574f, 2.595f, 2.602f, 2.593f, 2.582f, 2.577f, 2.593f, 2.638f, 2.71f,  2.805f,
       2.943f, 3.09f,  3.241f, 3.378f, 3.511f, 3.638f, 3.752f, 3.861f, 3.962f, 4.062f, 4.158f,
       4.253f, 4.345f, 4.436f, 4.522f, 4.607f, 4.692f, 4.776f, 4.861f}}},
    {"metal-CuZn-eta",
     {{1.487f, 1.471f, 1.445f, 1.405f, 1.35f,  1.278f, 1.191f, 1.094f, 0.994f, 0.9f,   0.816f,
       0.745f, 0.686f, 0.639f, 0.602f, 0.573f, 0.549f, 0.527f, 0.505f, 0.484f, 0.468f, 0.46f,
       0.45f,  0.452f, 0.449f, 0.445f, 0.444f, 0.444f, 0.445f, 0.444f, 0.444f, 0.445f, 0.446f,
       0.448f, 0.45f,  0.452f, 0.455f, 0.457f, 0.458f, 0.46f,  0.464f}}},
    {"metal-CuZn-k",
     {{1.818f, 1.813f, 1.805f, 1.794f, 1.786f, 1.784f, 1.797f, 1.829f, 1.883f, 1.957f, 2.046f,
       2.145f, 2.25f,  2.358f, 2.464f, 2.568f, 2.668f, 2.765f, 2.86f,  2.958f, 3.059f, 3.159f,
       3.253f, 3.345f, 3.434f, 3.522f, 3.609f, 3.695f, 3.778f, 3.86f,  3.943f, 4.025f, 4.106f,
       4.186f, 4.266f, 4.346f, 4.424f, 4.501f, 4.579f, 4.657f, 4.737f}}},
    {"metal-MgO-eta",
     {{1.767f, 1.765f, 1.762f, 1.76f,  1.758f, 1.756f, 1.754f, 1.752f, 1.751f, 1.749f, 1.748f,
       1.747f, 1.745f, 1.744f, 1.743f, 1.742f, 1.741f, 1.74f,  1.74f,  1.739f, 1.738f, 1.737f,
       1.737f, 1.736f, 1.735f, 1.735f, 1.734f, 1.734f, 1.733f, 1.733f, 1.732f, 1.732f, 1.731f,
       1.731f, 1.731f, 1.73f,  1.73f,  1.729f, 1.729f, 1.729f, 1.729f}}},
    {"metal-MgO-k", {{}}},
    {"metal-TiO2-eta",
     {{3.599f, 3.475f, 3.399f, 3.267f, 3.29f,  3.245f, 3.2f,   3.165f, 3.13f, 3.105f, 3.08f,
       3.055f, 3.03f,  3.015f, 3.0f,   2.974f, 2.97f,  2.955f, 2.94f,  2.93f, 2.92f,  2.91f,
       2.9f,   2.89f,  2.88f,  2.875f, 2.87f,  2.86f,  2.85f,  2.845f, 2.84f, 2.835f, 2.83f,
       2.825f, 2.82f,  2.815f, 2.81f,  2.81f,  2.81f,  2.805f, 2.8f}}},
    {"metal-TiO2-k",
     {{0.07196f, 0.0f, 0.0001182f, 0.01831f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f,
       0.0f,     0.0f, 0.0f,       0.0f,     0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f,
       0.0f,     0.0f, 0.0f,       0.0f,     0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f,
       0.0f,     0.0f, 0.0f,       0.0f,     0.0f, 0.0f, 0.0f, 0.0f}}},
}};

/// A glass by the coefficients of Sellmeier's formula, lengths in micrometres.
struct Glass {
    std::string_view name;
    std::array<double, 3> b, c;
    float index(double nanometres) const {
        const double l2 = nanometres * nanometres * 1e-6;
        double n2 = 1;
        for (size_t i = 0; i < b.size(); ++i) n2 += b[i] * l2 / (l2 - c[i]);
        return static_cast<float>(std::sqrt(n2));
    }
};
// Schott's data sheets (refractiveindex.info, CC0); F5, F10 and F11 are SF5, SF10 and SF11.
constexpr std::array<Glass, 7> kGlasses{{
    {"glass-BK7", {1.03961212, 0.231792344, 1.01046945}, {0.00600069867, 0.0200179144, 103.560653}},
    {"glass-BAF10",
     {1.5851495, 0.143559385, 1.08521269},
     {0.00926681282, 0.0424489805, 105.613573}},
    {"glass-FK51A",
     {0.971247817, 0.216901417, 0.904651666},
     {0.00472301995, 0.0153575612, 168.68133}},
    {"glass-LASF9",
     {2.00029547, 0.298926886, 1.80691843},
     {0.0121426017, 0.0538736236, 156.530829}},
    {"glass-F5", {1.52481889, 0.187085527, 1.42729015}, {0.011254756, 0.0588995392, 129.141675}},
    {"glass-F10", {1.62153902, 0.256287842, 1.64447552}, {0.0122241457, 0.0595736775, 147.468793}},
    {"glass-F11", {1.73759695, 0.313747346, 1.89878101}, {0.013188707, 0.0623068142, 155.23629}},
}};

struct Illuminant {
    std::string_view name;
    double x, y;
};
// Illuminants by their CIE 1931 chromaticities (CIE 15:2004; ACES white: Academy TB-2018-001).
constexpr std::array<Illuminant, 16> kIlluminants{{{"stdillum-A", 0.4476, 0.4074},
                                                   {"stdillum-D50", 0.3457, 0.3585},
                                                   {"stdillum-D65", 0.3127, 0.3290},
                                                   {"stdillum-F1", 0.3131, 0.3371},
                                                   {"stdillum-F2", 0.3721, 0.3751},
                                                   {"stdillum-F3", 0.4091, 0.3941},
                                                   {"stdillum-F4", 0.4402, 0.4031},
                                                   {"stdillum-F5", 0.3138, 0.3452},
                                                   {"stdillum-F6", 0.3779, 0.3882},
                                                   {"stdillum-F7", 0.3129, 0.3292},
                                                   {"stdillum-F8", 0.3458, 0.3586},
                                                   {"stdillum-F9", 0.3741, 0.3727},
                                                   {"stdillum-F10", 0.3458, 0.3588},
                                                   {"stdillum-F11", 0.3805, 0.3769},
                                                   {"stdillum-F12", 0.4370, 0.4042},
                                                   {"illum-acesD60", 0.32168, 0.33767}}};

template <typename Table>
auto entry(const Table& table, std::string_view name) {
    return std::find_if(table.begin(), table.end(), [&](const auto& e) { return e.name == name; });
}

}  // namespace

std::optional<Spectrum> material_spectrum(std::string_view name) {
    Spectrum s;
    s.extends = true;
    if (const auto glass = entry(kGlasses, name); glass != kGlasses.end()) {
        constexpr int kFinest = 5, kCount = 81;  // nanometres: the index bends more towards blue
        for (int i = 0; i < kCount; ++i) {
            s.wavelengths.push_back(kFirst + float(kFinest * i));
            s.values.push_back(glass->index(double(s.wavelengths.back())));
        }
        return s;
    }
    const auto metal = entry(kMetals, name);
    if (metal == kMetals.end()) return std::nullopt;
    for (size_t i = 0; i < kSamples; ++i) {
        s.wavelengths.push_back(kFirst + kStep * static_cast<float>(i));
        s.values.push_back(metal->values[i]);
    }
    return s;
}

std::optional<Rgb> illuminant_colour(std::string_view name) {
    const auto found = entry(kIlluminants, name);
    if (found == kIlluminants.end()) return std::nullopt;
    return chromaticity_colour(found->x, found->y);
}

const std::vector<std::string>& spectrum_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const Metal& m : kMetals) all.emplace_back(m.name);
        for (const Glass& g : kGlasses) all.emplace_back(g.name);
        for (const Illuminant& i : kIlluminants) all.emplace_back(i.name);
        return all;
    }();
    return names;
}

}  // namespace covtrace
