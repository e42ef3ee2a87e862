#include "colour/white_balance.h"

#include <cmath>

#include "colour/spectrum.h"

namespace covtrace {

namespace {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;

/// Matrix from XYZ to Bradford's cone responses.
constexpr Matrix kConesFromXyz{
    {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};
/// Matrix from linear Rec.709 to XYZ, from the primaries and D65.
constexpr Matrix kXyzFromRgb{{{0.4123907992659595, 0.3575843393838780, 0.1804807884018343},
                              {0.2126390058715104, 0.7151686787677559, 0.0721923153607337},
                              {0.0193308187155918, 0.1191947797946259, 0.9505321522496606}}};

Vector operator*(const Matrix& m, const Vector& v) {
    Vector r{};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) r[i] += m[i][j] * v[j];
    return r;
}
Matrix operator*(const Matrix& a, const Matrix& b) {
    Matrix r{};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j)
            for (size_t k = 0; k < 3; ++k) r[i][j] += a[i][k] * b[k][j];
    return r;
}
Matrix inverse(const Matrix& m) {
    const auto minor = [&m](size_t i, size_t j) {
        const size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
        return m[a][c] * m[b][d] - m[a][d] * m[b][c];
    };
    const double determinant =
        m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    Matrix r{};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) r[i][j] = minor(j, i) / determinant;
    return r;
}

/// White point, as XYZ with Y = 1, of daylight (CIE 15:2004, section 3.1) or of a black body.
Vector white_of(double kelvin) {
    // The temperature is corrected, because the constant c2 has changed since the illuminants were
    // defined.
    const double t = kelvin * 1.4388 / 1.4380;
    if (t < 4000) {
        const Rgb c = emission_colour(blackbody_spectrum(t));
        return kXyzFromRgb * Vector{c.r, c.g, c.b};
    }
    const double x = t <= 7000
                         ? -4.6070e9 / (t * t * t) + 2.9678e6 / (t * t) + 0.09911e3 / t + 0.244063
                         : -2.0064e9 / (t * t * t) + 1.9018e6 / (t * t) + 0.24748e3 / t + 0.237040;
    const double y = -3 * x * x + 2.870 * x - 0.275;
    return {x / y, 1, (1 - x - y) / y};
}

}  // namespace

std::array<std::array<float, 3>, 3> white_balance(float kelvin) {
    const Vector from = kConesFromXyz * white_of(kelvin);
    const Vector to = kConesFromXyz * (kXyzFromRgb * Vector{1, 1, 1});
    const Matrix cones_from_rgb = kConesFromXyz * kXyzFromRgb;
    Matrix scaled = cones_from_rgb;
    for (size_t i = 0; i < 3; ++i)
        for (double& v : scaled[i]) v *= to[i] / from[i];
    const Matrix m = inverse(cones_from_rgb) * scaled;
    std::array<std::array<float, 3>, 3> r{};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) r[i][j] = static_cast<float>(m[i][j]);
    return r;
}

}  // namespace covtrace
