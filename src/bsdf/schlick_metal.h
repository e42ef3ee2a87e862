/// A metal that is known by its colours at three angles, and not by its index.
#pragma once

#include "core/vec.h"

namespace covtrace {

/// A metal's reflectance by Schlick's formula, with a dip before grazing angles: with m = 1 -
/// cos_i,
///
///    r + (g - r) m^5 - d cos_i m^6
///
/// and 0 where that is less (Kutz, Hasan and Edmondson 2021, "Novel aspects of the Adobe Standard
/// Material", with g = 1). T: a colour, or one channel of it.
template <typename T>
struct SchlickMetal {
    T normal{}, grazing{};  ///< r and g, in [0, 1]
    T dip{};                ///< d, at least 0
};
template <typename S>
S schlick_reflectance(const S& cos_i, const SchlickMetal<float>& metal) {
    const S m = 1 - cos_i, m2 = m * m;
    const S f =
        metal.normal + m2 * m2 * m * (metal.grazing - metal.normal - metal.dip * (cos_i * m));
    return f > 0.0f ? f : S(0.0f);
}
inline Rgb schlick_reflectance(float cos_i, const SchlickMetal<Rgb>& metal) {
    const auto channel = [&](int c) {
        return schlick_reflectance(
            clamp01(cos_i), SchlickMetal<float>{metal.normal[c], metal.grazing[c], metal.dip[c]});
    };
    return {channel(0), channel(1), channel(2)};
}
/// The metal whose reflectance at the angle with the cosine 1/7, 82 degrees, where the dip is
/// deepest, is `edge` times Schlick's for `normal`; both in [0, 1].
inline SchlickMetal<Rgb> metal_of_edge(Rgb normal, Rgb edge) {
    constexpr float kCosine = 1 / 7.0f, kRest = 1 - kCosine,
                    kFifth = kRest * kRest * kRest * kRest * kRest;
    const Rgb at_edge = normal + (Rgb(1) - normal) * kFifth;
    return {normal, Rgb(1), at_edge * (Rgb(1) - edge) * (1 / (kCosine * kFifth * kRest))};
}

}  // namespace covtrace
