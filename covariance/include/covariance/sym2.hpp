// 2x2 and 3x3 blocks: Mat2 (general), Sym2 (symmetric, with eigen-decomposition and a generalised
// inverse) and Sym3 (a second-moment or normal tensor in world space).
#pragma once

#include <cmath>

#include "covariance/vec3.hpp"

namespace covariance {

/// A general 2x2 matrix [m00 m01; m10 m11].
template <std::floating_point T = double>
struct Mat2 {
    T m00 = 0, m01 = 0, m10 = 0, m11 = 0;

    [[nodiscard]] static constexpr Mat2 identity() noexcept { return {1, 0, 0, 1}; }

    friend constexpr Mat2 operator*(const Mat2& a, const Mat2& b) noexcept {
        return {sum_of_products(a.m00, b.m00, a.m01, b.m10),
                sum_of_products(a.m00, b.m01, a.m01, b.m11),
                sum_of_products(a.m10, b.m00, a.m11, b.m10),
                sum_of_products(a.m10, b.m01, a.m11, b.m11)};
    }
    friend constexpr Mat2 operator+(const Mat2& a, const Mat2& b) noexcept {
        return {a.m00 + b.m00, a.m01 + b.m01, a.m10 + b.m10, a.m11 + b.m11};
    }
    friend constexpr Mat2 operator*(T s, const Mat2& a) noexcept {
        return {s * a.m00, s * a.m01, s * a.m10, s * a.m11};
    }
    friend constexpr bool operator==(const Mat2&, const Mat2&) noexcept = default;
};

/// The transpose.
template <std::floating_point T>
[[nodiscard]] constexpr Mat2<T> transpose(const Mat2<T>& a) noexcept {
    return {a.m00, a.m10, a.m01, a.m11};
}

/// The determinant.
template <std::floating_point T>
[[nodiscard]] constexpr T det(const Mat2<T>& a) noexcept {
    return a.m00 * a.m11 - a.m01 * a.m10;
}

/// The inverse; infinite or NaN entries where the matrix is singular.
template <std::floating_point T>
[[nodiscard]] constexpr Mat2<T> inverse(const Mat2<T>& a) noexcept {
    return (1 / det(a)) * Mat2<T>{a.m11, -a.m01, -a.m10, a.m00};
}

/// A symmetric 2x2 matrix [xx xy; xy yy].
template <std::floating_point T = double>
struct Sym2 {
    T xx = 0, xy = 0, yy = 0;

    [[nodiscard]] static constexpr Sym2 diagonal(T a, T b) noexcept { return {a, 0, b}; }

    constexpr operator Mat2<T>() const noexcept {  // NOLINT(google-explicit-constructor)
        return {xx, xy, xy, yy};
    }
    friend constexpr Sym2 operator+(const Sym2& a, const Sym2& b) noexcept {
        return {a.xx + b.xx, a.xy + b.xy, a.yy + b.yy};
    }
    friend constexpr Sym2 operator-(const Sym2& a, const Sym2& b) noexcept {
        return {a.xx - b.xx, a.xy - b.xy, a.yy - b.yy};
    }
    friend constexpr Sym2 operator*(T s, const Sym2& a) noexcept {
        return {s * a.xx, s * a.xy, s * a.yy};
    }
    friend constexpr bool operator==(const Sym2&, const Sym2&) noexcept = default;
};

/// The determinant.
template <std::floating_point T>
[[nodiscard]] constexpr T det(const Sym2<T>& a) noexcept {
    return a.xx * a.yy - a.xy * a.xy;
}

/// The trace: the sum of the diagonal and of both eigenvalues.
template <std::floating_point T>
[[nodiscard]] constexpr T trace(const Sym2<T>& a) noexcept {
    return a.xx + a.yy;
}

/// The covariance S seen in coordinates q with p = M q: M^T S M.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> congruence(const Sym2<T>& s, const Mat2<T>& m) noexcept {
    const Mat2<T> sm = Mat2<T>(s) * m;
    return {sum_of_products(m.m00, sm.m00, m.m10, sm.m10),
            sum_of_products(m.m00, sm.m01, m.m10, sm.m11),
            sum_of_products(m.m01, sm.m01, m.m11, sm.m11)};
}

/// The inverse; infinite or NaN entries where the matrix is singular.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> inverse(const Sym2<T>& a) noexcept {
    return (1 / det(a)) * Sym2<T>{a.yy, -a.xy, a.xx};
}

/// The inverse of a positive semi-definite matrix, the pseudo-inverse where it is singular.
///
/// Singular means that the determinant is rounding noise beside the product of the diagonal, a test
/// that does not depend on the units of the two axes. A rank-one B has the pseudo-inverse
/// B / trace(B)^2; zero has zero.
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> pseudo_inverse(const Sym2<T>& a) noexcept {
    if (det(a) > noise_level<T> * a.xx * a.yy) return inverse(a);
    const T sum = trace(a);
    return sum > 0 ? (1 / (sum * sum)) * a : Sym2<T>{};
}

/// Eigenvalues `high` >= `low`, and the unit eigenvector (`x`, `y`) of `high`.
template <std::floating_point T = double>
struct Eigen2 {
    T high = 0, low = 0, x = 1, y = 0;
};

/// The eigen-decomposition of a symmetric 2x2 matrix.
template <std::floating_point T>
[[nodiscard]] Eigen2<T> eigen(const Sym2<T>& a) noexcept {
    const T mean = (a.xx + a.yy) / 2;
    const T half = (a.xx - a.yy) / 2;
    // The radius is a hypot, written out: squares of entries this library meets may leave the range
    // of float, their ratio does not.
    const T longer = std::max(std::abs(half), std::abs(a.xy));
    const T shorter = std::min(std::abs(half), std::abs(a.xy));
    if (!(longer > 0)) return {mean, mean, 1, 0};
    const T slope = shorter / longer;
    const T radius = longer * std::sqrt(1 + slope * slope);
    const T cos2 = half / radius, sin2 = a.xy / radius;  // of twice the angle of the eigenvector
    T x = 0, y = 0;
    if (cos2 >= 0) {
        x = std::sqrt((1 + cos2) / 2);
        y = sin2 / (2 * x);
    } else {
        y = std::sqrt((1 - cos2) / 2);
        x = sin2 / (2 * y);
    }
    // The eigenvalue of smaller size follows from the product of both: mean - radius would cancel.
    const T large = mean < 0 ? mean - radius : mean + radius;
    const T small = det(a) / large;
    return {std::max(large, small), std::min(large, small), x, y};
}

/// The symmetric matrix with the eigenvectors of `a` and the eigenvalues f(lambda).
template <std::floating_point T, typename F>
[[nodiscard]] Sym2<T> map_eigenvalues(const Sym2<T>& a, F f) noexcept {
    const Eigen2<T> e = eigen(a);
    const T high = f(e.high), low = f(e.low);
    return {high * e.x * e.x + low * e.y * e.y, (high - low) * e.x * e.y,
            high * e.y * e.y + low * e.x * e.x};
}

/// The matrix `a` with its eigenvalues brought into [low, high].
template <std::floating_point T>
[[nodiscard]] Sym2<T> clamp_eigenvalues(const Sym2<T>& a, NonDeduced<T> low,
                                        NonDeduced<T> high) noexcept {
    return map_eigenvalues(a, [=](T lambda) { return std::clamp(lambda, low, high); });
}

/// A symmetric 3x3 tensor in world space, for example sum a_i n_i n_i^T over the facets of a voxel.
template <std::floating_point T = double>
struct Sym3 {
    T xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

    /// Adds weight * v v^T.
    constexpr Sym3& add_outer(const Vec3<T>& v, T weight = 1) noexcept {
        xx += weight * v.x * v.x;
        xy += weight * v.x * v.y;
        xz += weight * v.x * v.z;
        yy += weight * v.y * v.y;
        yz += weight * v.y * v.z;
        zz += weight * v.z * v.z;
        return *this;
    }
    friend constexpr Vec3<T> operator*(const Sym3& a, const Vec3<T>& v) noexcept {
        return {a.xx * v.x + a.xy * v.y + a.xz * v.z, a.xy * v.x + a.yy * v.y + a.yz * v.z,
                a.xz * v.x + a.yz * v.y + a.zz * v.z};
    }
    friend constexpr bool operator==(const Sym3&, const Sym3&) noexcept = default;
};

/// The tensor N seen in the plane of two unit vectors: B^T N B with B = [a b].
template <std::floating_point T>
[[nodiscard]] constexpr Sym2<T> restrict_to(const Sym3<T>& n, const Vec3<NonDeduced<T>>& a,
                                            const Vec3<NonDeduced<T>>& b) noexcept {
    return {dot(a, n * a), dot(a, n * b), dot(b, n * b)};
}

}  // namespace covariance
