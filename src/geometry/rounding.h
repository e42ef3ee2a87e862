/// How far from where they belong single precision puts rays, along the normals of what they meet.
#pragma once

#include "geometry/affine.h"

namespace covtrace {

/// Half a unit in the last place of single precision, relative: the error of one rounding.
inline constexpr double kHalfUlp = 5.9604644775390625e-8;

/// Bound on how far from a surface Embree meets it by a ray that starts `distance` away, `size`
/// being the surface's extent: its sums are of corners relative to the ray's origin. What was seen
/// of a million rays at grazing and other angles is up to 4.8 roundings.
constexpr double meeting_error(double size, double distance) {
    return 8 * kHalfUlp * (size + distance);
}

/// One rounding each of the sums by which Embree carries a ray into an instance, along the unit
/// `normal`, all in the world: the part of a ray from `from` near `to` is off by a few of these.
/// The sums are as large as the instance's translation, and the distances from there.
inline double instance_rounding(const Affine& world_from_local, const Affine& local_from_world,
                                Vec3d normal, Vec3d from, Vec3d to) {
    const Vec3d origin = world_from_local.translation;
    const Vec3d local =
        local_from_world.absolute(abs(origin) + abs(from - origin) + abs(to - from));
    return kHalfUlp * dot(abs(world_from_local.transposed(normal)), local);
}

/// Roundings of instances that all but one of a thousand rays suffer at most: points that move off
/// by so many, and are rounded away from the surface, had no ray of 400,000 meet it, and a shade as
/// near as eight steps of single precision hid all of 300,000 (docs/decisions/0141).
inline constexpr double kUsualInstanceRoundings = 2.5;

/// Bound on where float arithmetic may put a ray that starts at a hit and that Embree carries into
/// the hit's instance, whichever way it goes: each coordinate suffers a few roundings of sums as
/// large as these.
inline double instance_error(const Affine& world_from_local, const Affine& local_from_world,
                             Vec3d position) {
    const Vec3d local =
        local_from_world.absolute(abs(position) + abs(world_from_local.translation));
    return 6 * kHalfUlp * length(world_from_local.absolute(local));
}

}  // namespace covtrace
