/// How far from where they belong single precision puts points.
#pragma once

#include "geometry/affine.h"

namespace covtrace {

/// Half a unit in the last place of single precision, relative: the error of one rounding.
inline constexpr double kHalfUlp = 5.9604644775390625e-8;

/// Bound on where float arithmetic may put a ray that Embree carries into an instance and back:
/// each coordinate suffers a few roundings of sums as large as these.
inline double instance_error(const Affine& world_from_local, const Affine& local_from_world,
                             Vec3d position) {
    const Vec3d local =
        local_from_world.absolute(abs(position) + abs(world_from_local.translation));
    return 6 * kHalfUlp * length(world_from_local.absolute(local));
}

/// Bound on the distance to its surface of a point that float arithmetic makes of an origin and at
/// most three vectors as long as `size`: each sum is rounded once. `normal` is the surface's, of
/// unit length.
inline float sum_error(Vec3 position, Vec3 normal, float size) {
    const double coordinates = dot(abs(Vec3d(normal)), abs(Vec3d(position)));
    return static_cast<float>(kHalfUlp * (3 * coordinates + 16 * double(size)));
}

}  // namespace covtrace
