/// Matrices between colour spaces, in double precision.
#pragma once

#include <array>
#include <cstddef>

namespace covtrace {

using Triple = std::array<double, 3>;
using Matrix3 = std::array<Triple, 3>;  ///< rows

/// Matrix from linear Rec.709 to XYZ, from the primaries and D65.
inline constexpr Matrix3 kXyzFromRec709{
    {{0.4123907992659595, 0.3575843393838780, 0.1804807884018343},
     {0.2126390058715104, 0.7151686787677559, 0.0721923153607337},
     {0.0193308187155918, 0.1191947797946259, 0.9505321522496606}}};

inline Triple product(const Matrix3& m, const Triple& v) {
    Triple r{};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) r[i] += m[i][j] * v[j];
    return r;
}
inline Matrix3 product(const Matrix3& a, const Matrix3& b) {
    Matrix3 r{};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j)
            for (size_t k = 0; k < 3; ++k) r[i][j] += a[i][k] * b[k][j];
    return r;
}
/// Inverse of a matrix that has one.
inline Matrix3 inverse(const Matrix3& m) {
    const auto minor = [&m](size_t i, size_t j) {
        const size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
        return m[a][c] * m[b][d] - m[a][d] * m[b][c];
    };
    const double determinant =
        m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    Matrix3 r{};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) r[i][j] = minor(j, i) / determinant;
    return r;
}
inline std::array<std::array<float, 3>, 3> single_precision(const Matrix3& m) {
    std::array<std::array<float, 3>, 3> r{};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) r[i][j] = static_cast<float>(m[i][j]);
    return r;
}

/// The matrix that takes inputs to outputs with the least sum of squares of what is left over.
class LeastSquares {
  public:
    /// Adds a pair that counts as much as `weight` of them.
    void add(const Triple& input, const Triple& output, double weight = 1) {
        for (size_t i = 0; i < 3; ++i)
            for (size_t j = 0; j < 3; ++j) {
                inputs_[i][j] += weight * input[i] * input[j];
                mixed_[i][j] += weight * output[i] * input[j];
            }
    }
    /// Takes at least three pairs with independent inputs.
    Matrix3 solve() const { return product(mixed_, inverse(inputs_)); }

  private:
    Matrix3 inputs_{}, mixed_{};
};

}  // namespace covtrace
