/// Vectors of eight points or directions, for the vector instructions of core/simd.h.
#pragma once

#include "core/simd.h"
#include "core/vec.h"

namespace covtrace {

/// Eight points or directions: lane k of x, y and z is the k-th.
struct Vec3x8 {
    Float8 x{}, y{}, z{};
};
inline Vec3x8 all8(Vec3 a) {
    return {all8(a.x), all8(a.y), all8(a.z)};
}
inline Vec3x8 operator-(const Vec3x8& a, const Vec3x8& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3x8 abs8(const Vec3x8& a) {
    return {abs8(a.x), abs8(a.y), abs8(a.z)};
}
inline Float8 dot8(const Vec3x8& a, const Vec3x8& b) {
    return multiply_add(a.z, b.z, multiply_add(a.y, b.y, a.x * b.x));
}
inline Vec3x8 cross8(const Vec3x8& a, const Vec3x8& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// The difference c - a s of vectors, with one factor s for each.
inline Vec3x8 subtract_product(const Vec3x8& a, const Float8& s, const Vec3x8& c) {
    return {subtract_product(a.x, s, c.x), subtract_product(a.y, s, c.y),
            subtract_product(a.z, s, c.z)};
}
/// The sum a s + c of vectors, with one factor s for each.
inline Vec3x8 multiply_add(const Vec3x8& a, const Float8& s, const Vec3x8& c) {
    return {multiply_add(a.x, s, c.x), multiply_add(a.y, s, c.y), multiply_add(a.z, s, c.z)};
}

}  // namespace covtrace
