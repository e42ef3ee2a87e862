/// Parts that all emissive shapes have in common: the point that light sampling finds on one, and
/// the room that it takes over the shutter.
#pragma once

#include <variant>
#include <vector>

#include "core/transform.h"
#include "geometry/rounding.h"
#include "light/tree.h"

namespace covtrace {

/// An emissive shape of either kind.
using Emitter = std::variant<class EmissiveMesh, class EmissiveQuadric>;

struct EmitterPoint {
    Vec3 position, normal;  ///< world; the unit normal is on the shape's outside
    Vec3d unrounded;        ///< `position` in double
    double error = 0;       ///< bound on how far from `unrounded`, along the normal, rays from the
                            ///< shading point meet the surface
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
