// Incoherent sums: the covariance of a sum of contributions is their mean weighted by radiance,
//
//   Sigma = sum w_i Sigma_i / sum w_i
//
// because Int |Lhat| = L(0) for positive spectra. This is the Monte Carlo estimator of a pixel, and
// how several arriving lights are merged at a vertex. (Additivity: property 5 of Belcour et al.
// 2013, "5D Covariance Tracing for Efficient Defocus and Motion Blur".) Also the harmonic sum, the
// covariance of a convolution of two signals.
#pragma once

#include <cmath>

#include "covariance/rotate.hpp"

namespace covariance {

/// Radiance-weighted mean of covariances that share their axes, such as those of one pixel.
///
/// The result depends on the order of additions in the last bit: one owner must add the paths of a
/// pixel, and merge partial sums, in a fixed order.
template <std::floating_point T = double>
class Accumulator {
  public:
    /// Adds one contribution. Weights that are not above zero, and matrices with an entry that is
    /// not finite, count as no contribution; returns whether it was added.
    bool add(const SymmetricMatrix5<T>& s, T weight) noexcept {
        if (!(weight > 0) || !std::isfinite(weight) || !is_finite(s)) return false;
        sum_ = sum_ + weight * s;
        weight_ += weight;
        return true;
    }

    /// Adds the contributions of another accumulator of the same pixel.
    constexpr void merge(const Accumulator& other) noexcept {
        sum_ = sum_ + other.sum_;
        weight_ += other.weight_;
    }

    /// Sum of the weights; 0 means that there is no estimate.
    [[nodiscard]] constexpr T weight() const noexcept { return weight_; }

    /// Sum of weight * matrix, for storing an unfinished state.
    [[nodiscard]] constexpr const SymmetricMatrix5<T>& sum() const noexcept { return sum_; }

    /// Makes an accumulator that continues from a stored state.
    [[nodiscard]] static constexpr Accumulator from_sum(const SymmetricMatrix5<T>& sum,
                                                        T weight) noexcept {
        Accumulator a;
        a.sum_ = sum;
        a.weight_ = weight;
        return a;
    }

    /// The weighted mean; zero where nothing was added.
    [[nodiscard]] constexpr SymmetricMatrix5<T> mean() const noexcept {
        return weight_ > 0 ? (1 / weight_) * sum_ : SymmetricMatrix5<T>{};
    }

  private:
    SymmetricMatrix5<T> sum_{};
    T weight_ = 0;
};

/// Merges two light fields of the same ray by radiance. The second is brought into the first's
/// frame.
///
/// Pre      both frames have the same Z; weights are at least 0. With both 0 the first is returned.
///          Between `surface_enter` and `surface_exit` x, y are tangent coordinates, which must not
///          turn with a frame: merge there only where both have the same X, Y, as two lights after
///          diffuse reflection do; else after `surface_exit`.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> merge(const LightField<T>& a, NonDeduced<T> weight_a,
                                            const LightField<NonDeduced<T>>& b,
                                            NonDeduced<T> weight_b) noexcept {
    if (!(weight_b > 0)) return a;
    const SymmetricMatrix5<T> other = rotate_to(b, a.frame).sigma;
    const T share = weight_b / (weight_a + weight_b);
    return {(1 - share) * a.sigma + share * other, a.frame};
}

/// Covariance of the convolution of two signals, (S1^-1 + S2^-1)^-1; exact for Gaussians.
///
/// Computed as S1 - S1 (S1 + S2)^-1 S1, which holds for singular matrices too. Symmetric in its
/// arguments up to rounding. Errors: none.
template <std::floating_point T>
[[nodiscard]] SymmetricMatrix5<T> harmonic_sum(SymmetricMatrix5<T> s1,
                                               const SymmetricMatrix5<NonDeduced<T>>& s2) noexcept {
    // Eliminate, one pivot at a time and the largest first, the five rows of the enlarged matrix
    // [S1 + S2, S1; S1, S1]; the result is the remainder of its last block.
    SymmetricMatrix5<T> b = s1 + s2;
    const SymmetricMatrix5<T> original = b;
    std::array<std::array<T, 5>, 5> r{};  // upper right block, row = axis of b
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t j = 0; j < 5; ++j) r[i][j] = s1(i, j);
    std::array<bool, 5> left{true, true, true, true, true};
    for (int step = 0; step < 5; ++step) {
        std::size_t p = 5;
        for (std::size_t i = 0; i < 5; ++i)
            if (left[i] && (p == 5 || b(i, i) > b(p, p))) p = i;
        left[p] = false;
        const T pivot = b(p, p);
        if (pivot <= noise_level<T> * original(p, p)) continue;
        for (std::size_t i = 0; i < 5; ++i)
            for (std::size_t j = i; j < 5; ++j) s1(i, j) -= r[p][i] * r[p][j] / pivot;
        for (std::size_t i = 0; i < 5; ++i) {
            if (!left[i]) continue;
            const T factor = b(i, p) / pivot;
            for (std::size_t j = 0; j < 5; ++j) r[i][j] -= factor * r[p][j];
            for (std::size_t j = i; j < 5; ++j)
                if (left[j]) b(i, j) -= factor * b(j, p);
        }
    }
    return s1;
}

}  // namespace covariance
