#include "shading/subsurface.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

namespace {

/// Shortest mean free path, scene units: below it light leaves where it enters, and extinction must
/// stay a number.
constexpr float kShortest = 1e-12f;

/// Share of the light that enters which leaves again, of a medium of the given s.
float reflected(float s, float inside, Entry entry) {
    const float diffuse = (1 - s) * (1 - 0.139f * s) / (1 + 1.17f * s);
    const float first = entry == Entry::diffuse ? diffuse : (1 - s) / (1 + 2 * s);
    return (1 - inside) * first / (1 - inside * diffuse);
}

/// The s of a medium of which the share `leaves` leaves again: that falls as s grows.
float find_s(float leaves, float inside, Entry entry) {
    float least = 0, most = 1;
    constexpr int kHalvings = 22;  // to the precision of a float below 1
    for (int i = 0; i < kHalvings; ++i) {
        const float middle = 0.5f * (least + most);
        (reflected(middle, inside, entry) > leaves ? least : most) = middle;
    }
    return leaves < 1 ? 0.5f * (least + most) : 0;
}

}  // namespace

float inner_reflectance(const CoatedDiffuseBsdf& border) {
    return std::max(0.0f, 1 - border.mean_transmission / (border.eta * border.eta));
}

Scattering scattering_of_reflectance(Rgb reflectance, Rgb mean_free_path, float g, float inside,
                                     Entry entry) {
    Scattering found;
    for (int c = 0; c < 3; ++c) {
        const float s2 = sqr(find_s(reflectance[c], inside, entry));
        const float albedo = (1 - s2) / (1 - g * s2);
        const float extinction = 1 / std::max(kShortest, mean_free_path[c]);
        found.scattering[c] = albedo * extinction;
        found.absorption[c] = (1 - albedo) * extinction;
    }
    return found;
}

Rgb reflectance_of_scattering(const Scattering& m, float g, float inside, Entry entry) {
    Rgb found;
    for (int c = 0; c < 3; ++c) {
        const float extinction = m.absorption[c] + m.scattering[c];
        const float albedo = extinction > 0 ? m.scattering[c] / extinction : 0;
        found[c] = reflected(std::sqrt((1 - albedo) / (1 - g * albedo)), inside, entry);
    }
    return found;
}

}  // namespace covtrace
