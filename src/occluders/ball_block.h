/// Eight balls side by side, so that a search looks at them together.
#pragma once

#include <array>
#include <limits>
#include <span>

#include "occluders/query.h"
#include "occluders/vec3x8.h"

namespace covtrace {

/// A ball in world space.
struct OccluderBall {
    Vec3 center;
    float radius = 0;
    OccluderQuery::Owner owner;  ///< shape and instance of the sphere in the scene
};

struct BallBlock {
    /// Makes a block of up to eight balls. A lane without a ball has a NaN centre, so that every
    /// comparison fails, and the radius 0.
    explicit BallBlock(std::span<const OccluderBall> balls) {
        const Float8 none = all8(std::numeric_limits<float>::quiet_NaN());
        center = {none, none, none};
        for (size_t k = 0; k < balls.size(); ++k) {
            center.x[k] = balls[k].center.x;
            center.y[k] = balls[k].center.y;
            center.z[k] = balls[k].center.z;
            radius[k] = balls[k].radius;
            shape[k] = balls[k].owner.shape;
            instance[k] = balls[k].owner.instance;
        }
    }

    /// A mask whose bit k tells whether the k-th ball is the owner's; bits of lanes without a ball
    /// mean nothing.
    unsigned owned_by(const OccluderQuery::Owner& owner) const {
        unsigned bits = 0;
        for (size_t k = 0; k < shape.size(); ++k)
            bits |= unsigned{shape[k] == owner.shape && instance[k] == owner.instance} << k;
        return owner.shape == OccluderQuery::Owner::kNone ? 0 : bits;
    }

    Vec3x8 center;
    Float8 radius{};
    std::array<uint32_t, 8> shape{}, instance{};
};

}  // namespace covtrace
