/// Affine maps as a translation after a rotation after a stretch, in the two ways that are of use:
/// pbrt's, which is interpolated in motions, and Embree's, which is what its instances can hold.
#pragma once

#include <array>

#include "core/transform.h"

namespace covtrace {

/// An affine map as the product translation * rotation * stretch.
struct Decomposition {
    Vec3 translation;
    Quaternion rotation;
    /// Matrix of the stretch, stretch[row][column].
    std::array<std::array<double, 3>, 3> stretch{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

/// Decomposes a map by the polar decomposition: the stretch is symmetric and positive definite, or
/// negative definite where the map mirrors. By Newton's iteration to the nearest rotation (Higham
/// 1986, "Computing the polar decomposition - with applications", SIAM J. Sci. Stat. Comput. 7(4)).
/// Where the matrix is singular, all of it is the stretch.
Decomposition polar_decomposition(const Matrix4& map);

/// Decomposes a map by Gram-Schmidt: the stretch is upper triangular, with a reflection in its last
/// element.
Decomposition triangular_decomposition(const Matrix4& map);

}  // namespace covtrace
