// From the five axes of the sensor to the two of the image: integration over lens and shutter.
//
//   B = Sigma + W,    Sigma_2D = B_ss - B_sr B_rr^-1 B_rs
//
// with s the axes pixel x and y, r the axes lens 1, lens 2 and shutter, and W the covariance of the
// window that lens and shutter are. A window multiplies, so its covariance adds; integrating slices
// the spectrum at zero, which for a Gaussian is the Schur complement. (Equation 5.3 of Belcour
// 2012, "A Frequency Analysis of Light Transport: From Theory to Implementation", must be read so.)
// It is not the block B_ss: that is the image of a pinhole camera at one instant.
#pragma once

#include <cmath>

#include "covariance/symmetric.hpp"

namespace covariance {

/// Spectral covariance 1/(4 pi^2 variance) of a window with the given variance.
template <std::floating_point T>
[[nodiscard]] constexpr T window_variance(T primal_variance) noexcept {
    return 1 / (four_pi_sq<T> * primal_variance);
}

/// Window of a disc aperture in units of its radius (variance 1/4): 1/pi^2 per axis.
template <std::floating_point T = double>
inline constexpr T disc_lens_window = 1 / (pi<T> * pi<T>);

/// Window of a square aperture [-1, 1]^2 (variance 1/3): 3/(4 pi^2) per axis.
template <std::floating_point T = double>
inline constexpr T square_lens_window = 3 / four_pi_sq<T>;

/// Window of a shutter that opens and closes at once, over [0, 1] (variance 1/12): 3/pi^2.
template <std::floating_point T = double>
inline constexpr T box_shutter_window = 3 / (pi<T> * pi<T>);

/// Window of lens and shutter for sensor coordinates: W = diag(0, 0, lens, lens, shutter).
template <std::floating_point T = double>
[[nodiscard]] constexpr SymmetricMatrix5<T> sensor_window(
    T lens = disc_lens_window<T>, NonDeduced<T> shutter = box_shutter_window<T>) noexcept {
    return SymmetricMatrix5<T>::diagonal(0, 0, lens, lens, shutter);
}

namespace detail {

/// Result of eliminating the axes u, v, t from S + W.
template <std::floating_point T>
struct Elimination {
    Sym2<T> schur;         ///< the Schur complement over x, y
    T ratio = 1;           ///< det (S + W)_rr / det W_rr over u, v, t
    bool windowed = true;  ///< whether W_rr is positive definite, so that the ratio means something
};

/// Eliminates u, v, t by Gauss' method with the largest pivot first. W is eliminated beside S + W:
/// its pivots bound the others from below, so that no rounding brings the ratio under 1. Without a
/// window, pivots that are rounding noise are left out, which for a positive semi-definite matrix
/// is a generalised inverse.
template <std::floating_point T>
[[nodiscard]] constexpr Elimination<T> eliminate_uvt(const SymmetricMatrix5<T>& s,
                                                     SymmetricMatrix5<T> w) noexcept {
    const SymmetricMatrix5<T> original = s + w;
    SymmetricMatrix5<T> b = original;
    std::array<bool, 5> left{true, true, true, true, true};
    Elimination<T> result;
    for (int step = 0; step < 3; ++step) {
        std::size_t p = 5;
        for (std::size_t i = 2; i < 5; ++i)
            if (left[i] && (p == 5 || b(i, i) > b(p, p))) p = i;
        left[p] = false;
        const T least = w(p, p), pivot = std::max(b(p, p), least);
        if (least > 0) {
            result.ratio *= pivot / least;
        } else {
            result.windowed = false;
            if (pivot <= noise_level<T> * original(p, p)) continue;
        }
        for (std::size_t i = 0; i < 5; ++i) {
            if (!left[i]) continue;
            const T factor = b(i, p) / pivot, factor_w = least > 0 ? w(i, p) / least : T(0);
            for (std::size_t j = i; j < 5; ++j) {
                if (!left[j]) continue;
                b(i, j) -= factor * b(j, p);
                w(i, j) -= factor_w * w(j, p);
            }
        }
    }
    result.schur = b.spatial();
    constexpr T noise = 16 * std::numeric_limits<T>::epsilon();
    if (b(0, 0) <= noise * original(0, 0)) result.schur.xx = result.schur.xy = 0;
    if (b(1, 1) <= noise * original(1, 1)) result.schur.yy = result.schur.xy = 0;
    return result;
}

}  // namespace detail

/// Integrates over lens and shutter: the Schur complement of Sigma + W, a 2x2 in (cycles/pixel)^2.
///
/// Shapes   s, window: sensor coordinates, `sensor_window()`.
/// Post     positive semi-definite, and in no direction above `project2(s)`.
/// Errors   none; a zero window is allowed and means an infinite, uniform one.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> preintegrate(
    const SymmetricMatrix5<T>& s,
    const SymmetricMatrix5<NonDeduced<T>>& window = sensor_window<T>()) noexcept {
    return detail::eliminate_uvt(s, window).schur;
}

/// Fixes lens point and time instead of integrating, which leaves the upper left block: the image
/// of a pinhole at one instant.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> project2(const SymmetricMatrix5<T>& s) noexcept {
    return s.spatial();
}

}  // namespace covariance
