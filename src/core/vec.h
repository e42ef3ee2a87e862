/// Small fixed-size vectors and linear RGB colours, in float. Plain aggregates: no invariants, no
/// allocation.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace covtrace {

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kInvPi = 0.31830988618379067154f;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Vec2 {
    float x = 0, y = 0;
    constexpr bool operator==(const Vec2&) const = default;
};
constexpr Vec2 operator+(Vec2 a, Vec2 b) {
    return {a.x + b.x, a.y + b.y};
}
constexpr Vec2 operator-(Vec2 a, Vec2 b) {
    return {a.x - b.x, a.y - b.y};
}
constexpr Vec2 operator*(Vec2 a, float s) {
    return {a.x * s, a.y * s};
}
constexpr Vec2 operator*(float s, Vec2 a) {
    return a * s;
}
constexpr float dot(Vec2 a, Vec2 b) {
    return a.x * b.x + a.y * b.y;
}
inline float length(Vec2 a) {
    return std::sqrt(dot(a, a));
}

/// A point, direction or normal in three dimensions.
struct Vec3 {
    float x = 0, y = 0, z = 0;
    constexpr float operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }
    constexpr float& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
    constexpr bool operator==(const Vec3&) const = default;
};
constexpr Vec3 operator+(Vec3 a, Vec3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr Vec3 operator-(Vec3 a, Vec3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr Vec3 operator-(Vec3 a) {
    return {-a.x, -a.y, -a.z};
}
constexpr Vec3 operator*(Vec3 a, float s) {
    return {a.x * s, a.y * s, a.z * s};
}
constexpr Vec3 operator*(float s, Vec3 a) {
    return a * s;
}
constexpr Vec3 operator*(Vec3 a, Vec3 b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
constexpr Vec3 operator/(Vec3 a, float s) {
    return a * (1.0f / s);
}
constexpr Vec3& operator+=(Vec3& a, Vec3 b) {
    return a = a + b;
}
constexpr Vec3& operator-=(Vec3& a, Vec3 b) {
    return a = a - b;
}
constexpr Vec3& operator*=(Vec3& a, float s) {
    return a = a * s;
}
constexpr float dot(Vec3 a, Vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr float abs_dot(Vec3 a, Vec3 b) {
    return dot(a, b) < 0 ? -dot(a, b) : dot(a, b);
}
constexpr Vec3 cross(Vec3 a, Vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
constexpr float length_squared(Vec3 a) {
    return dot(a, a);
}
inline float length(Vec3 a) {
    return std::sqrt(dot(a, a));
}
inline float distance(Vec3 a, Vec3 b) {
    return length(a - b);
}
/// Unit vector along `a`; the zero vector stays zero.
inline Vec3 normalize(Vec3 a) {
    const float l = length(a);
    return l > 0 ? a / l : a;
}
constexpr Vec3 min(Vec3 a, Vec3 b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
constexpr Vec3 max(Vec3 a, Vec3 b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
constexpr Vec3 lerp(float t, Vec3 a, Vec3 b) {
    return a * (1 - t) + b * t;
}
constexpr Vec3 face_forward(Vec3 n, Vec3 v) {
    return dot(n, v) < 0 ? -n : n;
}
inline bool is_finite(Vec3 a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// Linear colour with the Rec.709 primaries and white point D65.
struct Rgb {
    float r = 0, g = 0, b = 0;
    constexpr Rgb() = default;
    constexpr explicit Rgb(float v) : r(v), g(v), b(v) {}
    constexpr Rgb(float red, float green, float blue) : r(red), g(green), b(blue) {}
    constexpr float operator[](int i) const { return i == 0 ? r : (i == 1 ? g : b); }
    constexpr float& operator[](int i) { return i == 0 ? r : (i == 1 ? g : b); }
    constexpr bool operator==(const Rgb&) const = default;
};
constexpr Rgb operator+(Rgb a, Rgb b) {
    return {a.r + b.r, a.g + b.g, a.b + b.b};
}
constexpr Rgb operator-(Rgb a, Rgb b) {
    return {a.r - b.r, a.g - b.g, a.b - b.b};
}
constexpr Rgb operator*(Rgb a, Rgb b) {
    return {a.r * b.r, a.g * b.g, a.b * b.b};
}
constexpr Rgb operator/(Rgb a, Rgb b) {
    return {a.r / b.r, a.g / b.g, a.b / b.b};
}
constexpr Rgb operator*(Rgb a, float s) {
    return {a.r * s, a.g * s, a.b * s};
}
constexpr Rgb operator*(float s, Rgb a) {
    return a * s;
}
constexpr Rgb operator/(Rgb a, float s) {
    return a * (1.0f / s);
}
constexpr Rgb& operator+=(Rgb& a, Rgb b) {
    return a = a + b;
}
constexpr Rgb& operator*=(Rgb& a, Rgb b) {
    return a = a * b;
}
constexpr Rgb& operator*=(Rgb& a, float s) {
    return a = a * s;
}
/// Relative luminance (CIE Y) of a linear Rec.709 colour.
constexpr float luminance(Rgb c) {
    return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b;
}
constexpr float max_component(Rgb c) {
    return std::max(c.r, std::max(c.g, c.b));
}
constexpr bool is_black(Rgb c) {
    return c.r == 0 && c.g == 0 && c.b == 0;
}
inline bool is_finite(Rgb c) {
    return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
}
constexpr Rgb lerp(float t, Rgb a, Rgb b) {
    return a * (1 - t) + b * t;
}

constexpr float clamp01(float v) {
    return std::clamp(v, 0.0f, 1.0f);
}
constexpr float sqr(float v) {
    return v * v;
}
inline float safe_sqrt(float v) {
    return std::sqrt(std::max(0.0f, v));
}

/// Axis-aligned box; empty when default constructed.
struct Bounds3 {
    Vec3 lo{kInfinity, kInfinity, kInfinity};
    Vec3 hi{-kInfinity, -kInfinity, -kInfinity};
    constexpr void extend(Vec3 p) {
        lo = min(lo, p);
        hi = max(hi, p);
    }
    constexpr void extend(const Bounds3& b) {
        lo = min(lo, b.lo);
        hi = max(hi, b.hi);
    }
    constexpr bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
    constexpr bool contains(Vec3 p) const {
        return p.x >= lo.x && p.y >= lo.y && p.z >= lo.z && p.x <= hi.x && p.y <= hi.y &&
               p.z <= hi.z;
    }
    constexpr Vec3 center() const { return (lo + hi) * 0.5f; }
    constexpr Vec3 diagonal() const { return hi - lo; }
    float radius() const { return empty() ? 0.0f : 0.5f * length(diagonal()); }
};

}  // namespace covtrace
