/// Every shape wherever it stands in the world at one time, with instances unrolled, for code that
/// goes over all surfaces of a scene. Only for .cpp files of this folder.
#pragma once

#include "geometry/placed_scene.h"

namespace covtrace {

struct Occurrence {
    const LocalShape* shape = nullptr;
    bool is_instanced = false;
    Affine world_from_local;
    bool moves = false;
    Affine velocity;  ///< velocity of the material at a world point, where it moves
};

/// All shapes that occlude, which interfaces do not, in a fixed order.
std::vector<Occurrence> occurrences(const Geometry::Impl& geometry, float time);

}  // namespace covtrace
