#include "colour/white_balance.h"

#include "colour/daylight.h"
#include "colour/matrix3.h"

namespace covtrace {

namespace {

/// Matrix from XYZ to Bradford's cone responses.
constexpr Matrix3 kConesFromXyz{
    {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};

Matrix3 balance(float kelvin) {
    const Triple from = product(kConesFromXyz, daylight_white(kelvin));
    const Triple to = product(kConesFromXyz, product(kXyzFromRec709, Triple{1, 1, 1}));
    const Matrix3 cones_from_rgb = product(kConesFromXyz, kXyzFromRec709);
    Matrix3 scaled = cones_from_rgb;
    for (size_t i = 0; i < 3; ++i)
        for (double& v : scaled[i]) v *= to[i] / from[i];
    return product(inverse(cones_from_rgb), scaled);
}

}  // namespace

std::array<std::array<float, 3>, 3> white_balance(float kelvin) {
    return single_precision(balance(kelvin));
}

std::array<std::array<float, 3>, 3> xyz_before_balance(float kelvin) {
    return single_precision(product(kXyzFromRec709, inverse(balance(kelvin))));
}

}  // namespace covtrace
