/// Emission that varies over space with a field, as that of a flame with its temperature.
#pragma once

#include <memory>
#include <vector>

#include "core/vec.h"
#include "volume/density_grid.h"

namespace covtrace {

/// Radiance as a function of a field's value, times another field.
struct Glow {
    std::shared_ptr<const DensityGrid> field;
    /// For values evenly from 0 to the field's largest one, both included; linear between them.
    std::vector<Rgb> radiance;
    std::shared_ptr<const DensityGrid> factor = {};  ///< null: 1 everywhere

    Rgb at(Vec3 point) const;
};

}  // namespace covtrace
