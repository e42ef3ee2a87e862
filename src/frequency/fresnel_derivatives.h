/// Fresnel's factor of a border with its derivatives in closed form: the values that
/// `border_reflectance` gives with cov::Taylor, for a third of the instructions.
#pragma once

#include <cmath>

#include "bsdf/lobe_function.h"
#include "covariance/jet.hpp"

namespace covtrace {

/// Reflectance R of the border of `lobe` as a function of the cosine, with derivatives at `c` in
/// (0, 1]; of a pane's two faces 2R/(1 + R).
///
/// Dielectric borders of the index e: with w = sqrt(e^2 - 1 + c^2), w' = c/w,
///
///     rs = (1 - e^2)/(c + w)^2          rs' = -2 rs/w
///     rp = (e^2 c - w)/(e^2 c + w)      rp' = 2 e^2 (e^2 - 1)/(w (e^2 c + w)^2)
///
/// and R = (rs^2 + rp^2)/2; 1 where reflection is total.
inline covariance::Taylor<double> reflectance_at(const LobeShare& lobe, double c) {
    if (!(lobe.border_eta > 0) || lobe.border_k > 0)
        return border_reflectance(lobe, covariance::Taylor<double>{c, 1, 0});
    const double e2 = double(lobe.border_eta) * lobe.border_eta, excess = e2 - 1;
    const double w2 = excess + c * c;
    if (!(w2 > 0)) return {1, 0, 0};
    const double w = std::sqrt(w2), i = 1 / w, q = 1 / (c + w), p = 1 / (e2 * c + w);
    const double rs = -excess * q * q, rs1 = -2 * rs * i, rs2 = (rs * c * i - rs1 * w) * 2 * i * i;
    const double rp = (e2 * c - w) * p, rp1 = 2 * e2 * excess * i * p * p,
                 rp2 = -rp1 * (c * i * i + 2 * p * (e2 + c * i));
    const covariance::Taylor<double> one{0.5 * (rs * rs + rp * rp), rs * rs1 + rp * rp1,
                                         rs1 * rs1 + rs * rs2 + rp1 * rp1 + rp * rp2};
    if (!lobe.is_pane) return one;
    const double j = 1 / (1 + one.value), slope = 2 * j * j;
    return {2 * one.value * j, slope * one.first,
            slope * (one.second - 2 * j * one.first * one.first)};
}

}  // namespace covtrace
