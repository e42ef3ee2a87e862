/// Clouds of noise.
#pragma once

#include "core/transform.h"
#include "volume/density_grid.h"

namespace covtrace {

/// pbrt-v4's medium "cloud": dense below half of the unit height, less the higher, in the shape of
/// noise that is bent by noise.
struct Cloud {
    Bounds3 bounds{{0, 0, 0}, {1, 1, 1}};
    float density = 1, wispiness = 1, frequency = 5;

    /// The density at a point of the space that the bounds are in, in [0, 1].
    float at(Vec3 p) const;
};

/// The cloud's density as a grid, fine enough for its finest noise up to 192 cells along the
/// longest side. Errors: those of DensityGrid.
DensityGrid cloud_grid(const Cloud& cloud, const Transform& cloud_from_world,
                       const SourceLocation& where = {});

}  // namespace covtrace
