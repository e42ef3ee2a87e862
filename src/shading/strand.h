/// Where a ray meets a strand of hair that a tube of flat or smooth sides stands for.
#pragma once

#include "bsdf/bsdf.h"
#include "geometry/hit.h"

namespace covtrace {

/// Place across a tube as seen along `wo` (unit, towards the viewer), in [-1, 1]: evenly
/// distributed over its width, whichever of its sides are seen. -1 and 1 are its outlines; the
/// place grows towards wo x dp/du. `sides`, at least 3: ShapeDescription::tube_sides.
float place_across(const SurfaceHit& hit, int sides, Vec3 wo);

/// Gives a BSDF of hair its place across the tube that was hit; others, and hair on what is no tube
/// (`sides` is 0), stay as they are.
inline void place_on_strand(Bsdf& bsdf, const SurfaceHit& hit, int sides, Vec3 wo) {
    if (auto* hair = std::get_if<HairBsdf>(&bsdf); hair && sides > 0)
        hair->offset = place_across(hit, sides, wo);
}

}  // namespace covtrace
