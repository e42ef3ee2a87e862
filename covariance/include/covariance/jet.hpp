// Jet: a value with its first and second derivatives in two variables, for exact (forward-mode)
// derivatives of a BRDF that is written once, as a template over its scalar type.
#pragma once

#include <cmath>

#include "covariance/vec3.hpp"

namespace covariance {

/// Values of f(u, v) to second order about (0, 0). Arithmetic on jets follows the rules of
/// differentiation, so that a formula in jets gives its own gradient and Hessian without a step
/// width.
///
/// Comparisons look at the value alone: branches and clamps behave as they do on plain numbers.
/// Units    of `value`, per unit of u and v, and per its square.
template <std::floating_point T = double>
struct Jet {
    T value = 0;
    T u = 0, v = 0;            ///< df/du, df/dv
    T uu = 0, uv = 0, vv = 0;  ///< second derivatives

    constexpr Jet() noexcept = default;
    /// Makes a constant, whose derivatives are zero.
    constexpr Jet(T constant) noexcept : value(constant) {}  // NOLINT(google-explicit-constructor)
    constexpr Jet(T value_, T u_, T v_, T uu_ = 0, T uv_ = 0, T vv_ = 0) noexcept
        : value(value_), u(u_), v(v_), uu(uu_), uv(uv_), vv(vv_) {}

    friend constexpr Jet operator+(const Jet& a, const Jet& b) noexcept {
        return {a.value + b.value, a.u + b.u, a.v + b.v, a.uu + b.uu, a.uv + b.uv, a.vv + b.vv};
    }
    friend constexpr Jet operator-(const Jet& a) noexcept {
        return {-a.value, -a.u, -a.v, -a.uu, -a.uv, -a.vv};
    }
    friend constexpr Jet operator-(const Jet& a, const Jet& b) noexcept { return a + -b; }
    friend constexpr Jet operator*(const Jet& a, const Jet& b) noexcept {
        return {a.value * b.value,
                a.value * b.u + a.u * b.value,
                a.value * b.v + a.v * b.value,
                a.value * b.uu + 2 * a.u * b.u + a.uu * b.value,
                a.value * b.uv + a.u * b.v + a.v * b.u + a.uv * b.value,
                a.value * b.vv + 2 * a.v * b.v + a.vv * b.value};
    }
    friend constexpr Jet operator/(const Jet& a, const Jet& b) noexcept {
        const T i = 1 / b.value;
        return a * compose(b, i, -i * i, 2 * i * i * i);
    }
    // Operations with constants, which have no derivatives to carry along.
    friend constexpr Jet operator+(Jet a, T c) noexcept {
        a.value += c;
        return a;
    }
    friend constexpr Jet operator+(T c, const Jet& a) noexcept { return a + c; }
    friend constexpr Jet operator-(const Jet& a, T c) noexcept { return a + -c; }
    friend constexpr Jet operator-(T c, const Jet& a) noexcept { return -a + c; }
    friend constexpr Jet operator*(T c, const Jet& a) noexcept {
        return {c * a.value, c * a.u, c * a.v, c * a.uu, c * a.uv, c * a.vv};
    }
    friend constexpr Jet operator*(const Jet& a, T c) noexcept { return c * a; }
    friend constexpr Jet operator/(const Jet& a, T c) noexcept { return (1 / c) * a; }
    friend constexpr Jet operator/(T c, const Jet& b) noexcept {
        const T i = 1 / b.value, g = c * i;
        return compose(b, g, -g * i, 2 * g * i * i);
    }
    friend constexpr bool operator<(const Jet& a, const Jet& b) noexcept {
        return a.value < b.value;
    }
    friend constexpr bool operator>(const Jet& a, const Jet& b) noexcept { return b < a; }

    /// The jet of g(a), from the value and the first two derivatives of g at a.value.
    friend constexpr Jet compose(const Jet& a, T g, T g1, T g2) noexcept {
        return {g,
                g1 * a.u,
                g1 * a.v,
                g1 * a.uu + g2 * a.u * a.u,
                g1 * a.uv + g2 * a.u * a.v,
                g1 * a.vv + g2 * a.v * a.v};
    }
    /// The square root. Derivatives are infinite at 0.
    friend Jet sqrt(const Jet& a) noexcept {
        const T r = std::sqrt(a.value), g1 = 1 / (2 * r);
        return compose(a, r, g1, -g1 / (2 * a.value));
    }
    friend Jet exp(const Jet& a) noexcept {
        const T e = std::exp(a.value);
        return compose(a, e, e, e);
    }
    friend Jet log(const Jet& a) noexcept {
        const T i = 1 / a.value;
        return compose(a, std::log(a.value), i, -i * i);
    }
    friend Jet pow(const Jet& a, T exponent) noexcept {
        const T p = std::pow(a.value, exponent - 2);
        return compose(a, p * a.value * a.value, exponent * p * a.value,
                       exponent * (exponent - 1) * p);
    }
    /// The absolute value; at 0 that of the positive side.
    friend constexpr Jet abs(const Jet& a) noexcept { return a.value < 0 ? -a : a; }
};

/// A function of one variable to second order: its value, first and second derivative.
template <std::floating_point T = double>
struct Taylor {
    T value = 0, first = 0, second = 0;

    constexpr Taylor() noexcept = default;
    /// Makes a constant, whose derivatives are zero.
    constexpr Taylor(T constant) noexcept
        : value(constant) {}  // NOLINT(google-explicit-constructor)
    constexpr Taylor(T value_, T first_, T second_) noexcept
        : value(value_), first(first_), second(second_) {}

    friend constexpr Taylor operator+(const Taylor& a, const Taylor& b) noexcept {
        return {a.value + b.value, a.first + b.first, a.second + b.second};
    }
    friend constexpr Taylor operator-(const Taylor& a) noexcept {
        return {-a.value, -a.first, -a.second};
    }
    friend constexpr Taylor operator-(const Taylor& a, const Taylor& b) noexcept { return a + -b; }
    friend constexpr Taylor operator*(const Taylor& a, const Taylor& b) noexcept {
        return {a.value * b.value, a.first * b.value + a.value * b.first,
                a.second * b.value + 2 * a.first * b.first + a.value * b.second};
    }
    friend constexpr Taylor operator/(const Taylor& a, const Taylor& b) noexcept {
        // Differentiate a = q b twice.
        const T i = 1 / b.value, q = a.value * i, q1 = (a.first - q * b.first) * i;
        return {q, q1, (a.second - 2 * q1 * b.first - q * b.second) * i};
    }
    friend constexpr bool operator<(const Taylor& a, const Taylor& b) noexcept {
        return a.value < b.value;
    }
    friend constexpr bool operator>(const Taylor& a, const Taylor& b) noexcept { return b < a; }
    /// The square root. Derivatives are infinite at 0.
    friend Taylor sqrt(const Taylor& a) noexcept {
        // Differentiate a = r^2 twice.
        const T r = std::sqrt(a.value), i = 1 / (2 * r), r1 = a.first * i;
        return {r, r1, (a.second - 2 * r1 * r1) * i};
    }
};

/// The jet of f(x) for a function that is written once for every scalar type: by the chain rule
/// from its derivatives at x.value, which takes fewer operations than f in jets.
template <std::floating_point T, typename F>
[[nodiscard]] Jet<T> function_of(const F& f, const Jet<T>& x) noexcept {
    const Taylor<T> g = f(Taylor<T>{x.value, 1, 0});
    return compose(x, g.value, g.first, g.second);
}

/// The value f(x) for a Taylor expansion in one variable: the derivatives are carried through.
template <std::floating_point T, typename F>
[[nodiscard]] Taylor<T> function_of(const F& f, const Taylor<T>& x) noexcept {
    return f(x);
}

/// A vector of jets: a direction that depends on two slopes.
template <std::floating_point T = double>
struct JetVec3 {
    Jet<T> x, y, z;

    friend constexpr JetVec3 operator+(const JetVec3& a, const JetVec3& b) noexcept {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    friend constexpr JetVec3 operator+(const JetVec3& a, const Vec3<T>& b) noexcept {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    friend constexpr JetVec3 operator-(const JetVec3& a) noexcept { return {-a.x, -a.y, -a.z}; }
    friend constexpr JetVec3 operator*(const Jet<T>& s, const JetVec3& a) noexcept {
        return {s * a.x, s * a.y, s * a.z};
    }
    friend constexpr Jet<T> dot(const JetVec3& a, const JetVec3& b) noexcept {
        return a.x * b.x + a.y * b.y + a.z * b.z;
    }
    friend constexpr Jet<T> dot(const Vec3<T>& a, const JetVec3& b) noexcept {
        return a.x * b.x + a.y * b.y + a.z * b.z;
    }
};

/// The unit direction Z + u X + v Y, normalised, as a function of the slopes u and v.
///
/// Frame    x, y, z: the axes of a ray, orthonormal, in whatever coordinates the result is wanted
///          (for a BRDF those of its shading frame).
template <std::floating_point T>
[[nodiscard]] constexpr JetVec3<T> jet_direction(const Vec3<T>& x, const Vec3<NonDeduced<T>>& y,
                                                 const Vec3<NonDeduced<T>>& z) noexcept {
    // The normalisation is (1 + u^2 + v^2)^(-1/2) = 1 - (u^2 + v^2)/2 + ...
    return {{z.x, x.x, y.x, -z.x, 0, -z.x},
            {z.y, x.y, y.y, -z.y, 0, -z.y},
            {z.z, x.z, y.z, -z.z, 0, -z.z}};
}

/// A direction that does not depend on the slopes, as jets.
template <std::floating_point T>
[[nodiscard]] constexpr JetVec3<T> jet_constant(const Vec3<T>& w) noexcept {
    return {w.x, w.y, w.z};
}

/// Solid angle per area of slopes: (1 + u^2 + v^2)^(-3/2).
template <std::floating_point T>
[[nodiscard]] constexpr Jet<T> jet_solid_angle() noexcept {
    return {1, 0, 0, -3, 0, -3};
}

}  // namespace covariance
