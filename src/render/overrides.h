/// Changes that the command line and Python make to a scene before it is built.
#pragma once

#include <array>
#include <optional>

#include "image/image.h"
#include "scene/scene_description.h"

namespace covtrace {

/// Values that take the place of the scene's own, where they are given.
struct SceneOverrides {
    std::optional<std::array<int, 2>> resolution;
    std::optional<PixelBounds> crop;  ///< pixels, end exclusive
    std::optional<std::array<float, 2>> shutter;
    std::optional<float> focal_distance;
    std::optional<float> f_number;
    /// Least focal distance and f-number: smaller ones ask for lenses that single precision cannot
    /// hold.
    static constexpr double kLeastOfLens = 1e-9;
};

/// Applies resolution, crop, shutter, focus and f-number. Throws Error(usage) for a crop outside
/// the frame, Error(limit) for sizes that no machine holds.
void apply(const SceneOverrides& overrides, SceneDescription& scene);

/// The pixels that a description asks for: its crop window or pixel bounds within the frame.
PixelBounds render_region(const FilmDescription& film);

}  // namespace covtrace
