/// Affine maps as a translation after a rotation after a stretch, in the two ways that are of use:
/// pbrt's, which motions interpolate, and Embree's, which is what its instances can hold.
#pragma once

#include <array>

#include "core/transform.h"

namespace covtrace {

/// translation * rotation * stretch.
struct Decomposition {
    Vec3 translation;
    Quaternion rotation;
    /// Rows first.
    std::array<std::array<double, 3>, 3> stretch{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

/// The polar one: the stretch is symmetric and positive definite, or negative definite where the
/// map mirrors. By Newton's iteration to the nearest rotation (Higham, "Computing the polar
/// decomposition - with applications", SIAM J. Sci. Stat. Comput. 7(4), 1986). Where the matrix is
/// singular, all of it is the stretch.
Decomposition polar_decomposition(const Matrix4& map);

/// By Gram-Schmidt: the stretch is upper triangular, with a reflection in its last element.
Decomposition triangular_decomposition(const Matrix4& map);

}  // namespace covtrace
