/// Parts that all emissive shapes have in common: the point that light sampling finds on one, and
/// the room that it takes over the shutter.
#pragma once

#include <cmath>
#include <variant>
#include <vector>

#include "core/transform.h"
#include "geometry/motion.h"
#include "geometry/rounding.h"
#include "light/tree.h"

namespace covtrace {

/// An emissive shape of either kind.
using Emitter = std::variant<class EmissiveMesh, class EmissiveQuadric>;

struct EmitterPoint {
    Vec3 position, normal;  ///< world; the unit normal is on the shape's outside
    float error = 0;        ///< bound on the distance of `position` from the surface that rays meet
    Vec3 wi;                ///< unit, from the shading point
    float pdf = 0;          ///< per solid angle
    Vec2 place;             ///< barycentric coordinates in the light, of meshes only
};

/// The transform at times so close that the motion between them stays in a box around the shape at
/// all of these times, padded by half a step. A single transform where nothing moves.
inline std::vector<Transform> poses_over_time(const AnimatedTransform& motion) {
    if (!motion.is_animated()) return {motion.start()};
    constexpr int kSteps = 32;
    std::vector<Transform> poses;
    for (int i = 0; i <= kSteps; ++i)
        poses.push_back(motion.at(motion.start_time() +
                                  (motion.end_time() - motion.start_time()) * (float(i) / kSteps)));
    return poses;
}

/// Bound on the distance between points of a shape and where Embree has them while it moves, over
/// all its poses: found anew for each sample it takes a tenth of a render. `box`: of the shape in
/// its own space. 0 where nothing moves.
inline float motion_error(const AnimatedTransform& motion, const Bounds3& box) {
    if (!motion.is_animated()) return 0;
    double most = 0;
    for (const Transform& pose : poses_over_time(motion)) {
        const Affine map = Affine::from_matrix(pose.matrix());
        const Affine inverse = Affine::from_matrix(pose.inverse_matrix());
        const double scale = std::sqrt(dot(map.row[0], map.row[0]) + dot(map.row[1], map.row[1]) +
                                       dot(map.row[2], map.row[2]));
        Vec3d farthest;
        for (int i = 0; i < 8; ++i) {
            const Vec3 corner{i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y,
                              i & 4 ? box.hi.z : box.lo.z};
            const Vec3d at = abs(Vec3d(pose.point(corner)));
            farthest = {std::max(farthest.x, at.x), std::max(farthest.y, at.y),
                        std::max(farthest.z, at.z)};
        }
        most = std::max(most, kPlacementError * scale * 2 * double(box.radius()) +
                                  instance_error(map, inverse, farthest));
    }
    return static_cast<float>(most);
}

/// Collects where the corners of an emitter are over its poses.
class MotionBox {
  public:
    /// Adds the corners at one more pose; the same corners come in the same order each time.
    void add(const std::vector<Vec3>& corners) {
        for (size_t i = 0; i < corners.size(); ++i) {
            box_.extend(corners[i]);
            if (!previous_.empty()) step_ = std::max(step_, distance(corners[i], previous_[i]));
        }
        previous_ = corners;
    }
    Bounds3 box() const {
        const Vec3 pad{step_ / 2, step_ / 2, step_ / 2};
        return {box_.lo - pad, box_.hi + pad};
    }

  private:
    Bounds3 box_;
    float step_ = 0;
    std::vector<Vec3> previous_;
};

}  // namespace covtrace
