/// Emission that does not hang on how dense a medium is, as that of Blender's volumes.
#pragma once

#include <array>
#include <memory>

#include "core/vec.h"
#include "volume/density_grid.h"

namespace covtrace {

/// Radiance that is added per unit of length, over space.
struct EmissionField {
    std::shared_ptr<const DensityGrid> whole;  ///< the sum of the channels, for drawing places
    std::array<std::shared_ptr<const DensityGrid>, 3> channels;

    Rgb at(Vec3 point) const {
        return {channels[0]->at(point), channels[1]->at(point), channels[2]->at(point)};
    }
    size_t bytes() const {
        return whole->bytes() + channels[0]->bytes() + channels[1]->bytes() + channels[2]->bytes();
    }
};

}  // namespace covtrace
