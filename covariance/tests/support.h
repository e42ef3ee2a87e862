// Tools that the tests share: random matrices, frames and surfaces, and plain 5x5 algebra to
// compare with.
#pragma once

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <covariance/covariance.hpp>

namespace support {

using Matrix = covariance::SymmetricMatrix5<double>;
using Dense = covariance::Matrix5<double>;
using Vec3 = covariance::Vec3<double>;
using Frame = covariance::Frame<double>;
using Field = covariance::LightField<double>;
using Surface = covariance::Surface<double>;
using Motion = covariance::Motion<double>;
using Sym2 = covariance::Sym2<double>;
using Mat2 = covariance::Mat2<double>;

// ---- drawing: call these inside a RapidCheck property

inline double draw(double low, double high) {
    const int steps = 1'000'000;
    const int k = *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(0, steps + 1));
    return low + (high - low) * k / steps;
}

inline int draw_int(int low, int high_inclusive) {
    return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(low, high_inclusive + 1));
}

/// A positive semi-definite matrix of a random rank from `least_rank` to 5.
inline Matrix draw_psd(int least_rank = 1) {
    Matrix s;
    const int rank = draw_int(least_rank, 5);
    for (int r = 0; r < rank; ++r) {
        double w[5];
        for (double& x : w) x = draw(-2, 2);
        for (std::size_t i = 0; i < 5; ++i)
            for (std::size_t j = i; j < 5; ++j) s(i, j) += w[i] * w[j];
    }
    return s;
}

/// A positive definite matrix that is not nearly singular.
inline Matrix draw_pd() {
    return draw_psd(5) + Matrix::diagonal(0.3, 0.3, 0.3, 0.3, 0.3);
}

inline Sym2 draw_pd2() {
    const double a = draw(-2, 2), b = draw(-2, 2), c = draw(-2, 2), d = draw(-2, 2);
    return {a * a + b * b + 0.2, a * c + b * d, c * c + d * d + 0.2};
}

inline Vec3 draw_vec3(double size) {
    const double x = draw(-size, size), y = draw(-size, size), z = draw(-size, size);
    return {x, y, z};
}

inline Vec3 draw_direction() {
    const double z = draw(-1, 1), phi = draw(0, 6.28), r = std::sqrt(1 - z * z);
    return covariance::normalized_or(Vec3{r * std::cos(phi), r * std::sin(phi), z}, Vec3{0, 0, 1});
}

/// Another frame with the same Z: turned, and left-handed half of the time.
inline Frame draw_frame_like(const Frame& f) {
    const double a = draw(-3, 3), c = std::cos(a), s = std::sin(a);
    const Vec3 y = c * f.y - s * f.x;
    return {c * f.x + s * f.y, draw_int(0, 1) == 1 ? y : -y, f.z};
}

inline Frame draw_frame(const Vec3& z) {
    return draw_frame_like(covariance::frame_along<double>(z));
}

/// A curved surface with a random tangent basis whose normal makes a cosine of 0.2 to 1 with -z.
inline Surface draw_surface(const Vec3& z) {
    const Frame about = covariance::frame_along<double>(-z);
    const double c = draw(0.2, 1), phi = draw(0, 6.28), r = std::sqrt(1 - c * c);
    const Vec3 n = c * about.z + (r * std::cos(phi)) * about.x + (r * std::sin(phi)) * about.y;
    const Frame basis = draw_frame(n);
    const double k11 = draw(-1, 1), k12 = draw(-1, 1), k22 = draw(-1, 1);
    return {n, basis.x, basis.y, {k11, k12, k22}};
}

/// A direction on the side of the surface to which light that arrives along -n is reflected.
inline Vec3 draw_leaving(const Vec3& n) {
    const Frame about = covariance::frame_along<double>(n);
    const double c = draw(0.2, 1), phi = draw(0, 6.28), r = std::sqrt(1 - c * c);
    return c * about.z + (r * std::cos(phi)) * about.x + (r * std::sin(phi)) * about.y;
}

inline Motion draw_motion() {
    const Vec3 velocity = draw_vec3(2);
    return {velocity, draw_vec3(2)};
}

// ---- comparing

inline double largest(const Matrix& s) {
    double most = 0;
    for (const double x : s.values) most = std::max(most, std::abs(x));
    return most;
}

/// Distance max|a - b| of two matrices, relative to the largest entry of either and of `scale` (an
/// input whose rounding carries over).
inline double distance(const Matrix& a, const Matrix& b, double scale = 0) {
    const double size = std::max({largest(a), largest(b), scale});
    const double difference = largest(a - b);
    return size > 0 ? difference / size : difference;
}

inline double distance(const Sym2& a, const Sym2& b, double scale = 0) {
    Matrix a5, b5;
    a5.set_spatial(a);
    b5.set_spatial(b);
    return distance(a5, b5, scale);
}

// ---- plain algebra

/// Gauss-Jordan inverse with row pivoting; `det` receives the determinant.
inline Dense inverse(Dense a, double* det = nullptr) {
    Dense inv = Dense::identity();
    double product = 1;
    for (std::size_t c = 0; c < 5; ++c) {
        std::size_t p = c;
        for (std::size_t r = c; r < 5; ++r)
            if (std::abs(a(r, c)) > std::abs(a(p, c))) p = r;
        if (p != c) product = -product;
        std::swap(a.rows[p], a.rows[c]);
        std::swap(inv.rows[p], inv.rows[c]);
        const double pivot = a(c, c);
        product *= pivot;
        if (pivot == 0) break;  // singular
        for (std::size_t j = 0; j < 5; ++j) a(c, j) /= pivot, inv(c, j) /= pivot;
        for (std::size_t r = 0; r < 5; ++r) {
            if (r == c) continue;
            const double factor = a(r, c);
            for (std::size_t j = 0; j < 5; ++j)
                a(r, j) -= factor * a(c, j), inv(r, j) -= factor * inv(c, j);
        }
    }
    if (det != nullptr) *det = product;
    return inv;
}

inline Dense dense(const Matrix& s) {
    Dense a;
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t j = 0; j < 5; ++j) a(i, j) = s(i, j);
    return a;
}

inline Matrix inverse(const Matrix& s) {
    const Dense inv = inverse(dense(s));
    Matrix result;
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t j = i; j < 5; ++j) result(i, j) = (inv(i, j) + inv(j, i)) / 2;
    return result;
}

inline double determinant(const Matrix& s) {
    double det = 0;
    inverse(dense(s), &det);
    return det;
}

/// Whether no eigenvalue is below -1e-9 * size, by a Cholesky factorisation of the shifted matrix.
/// The size is the trace, or that of a matrix whose rounding carries over.
inline bool is_psd(Matrix s, double scale = 0) {
    const double size = std::max(covariance::trace(s), scale);
    if (!(size >= 0)) return false;
    if (size == 0) return largest(s) == 0;
    for (std::size_t i = 0; i < 5; ++i) s(i, i) += 1e-9 * size;
    for (std::size_t p = 0; p < 5; ++p) {
        if (!(s(p, p) > 0)) return false;
        for (std::size_t i = p + 1; i < 5; ++i)
            for (std::size_t j = i; j < 5; ++j) s(i, j) -= s(i, p) * s(p, j) / s(p, p);
    }
    return true;
}

inline bool is_psd(const Sym2& s, double scale = 0) {
    Matrix m;
    m.set_spatial(s);
    return is_psd(m, scale);
}

}  // namespace support
