/// Changes that the command line and Python make to a scene before it is built.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "image/image.h"
#include "scene/scene_description.h"

namespace covtrace {

/// A perspective pinhole, in place of the scene's camera.
struct CameraOverride {
    Vec3 eye, target;
    float fov = 0;                             ///< degrees, of the picture's shorter side
    std::optional<Vec3> up;                    ///< default: what is up in the scene
    static constexpr double kLeastFov = 1e-6;  ///< single precision tells no directions apart below
};

/// Light from all around, in place of the scene's infinite lights.
struct EnvironmentOverride {
    /// An image of the layouts that InfiniteLight has, in place of a colour.
    std::optional<std::filesystem::path> image;
    Rgb radiance{1};  ///< without an image: black takes the infinite lights away
};

/// Values that take the place of the scene's own, where they are given.
struct SceneOverrides {
    std::optional<std::array<int, 2>> resolution;
    std::optional<PixelBounds> crop;  ///< pixels, end exclusive
    std::optional<std::array<float, 2>> shutter;
    std::optional<float> focal_distance;
    std::optional<float> f_number;
    std::optional<int> max_depth;  ///< most scattering events of a path, at least 0
    std::optional<CameraOverride> camera;
    std::optional<EnvironmentOverride> environment;
    /// Degrees by which the infinite lights are turned about their poles: counterclockwise as seen
    /// from above, so that a picture moves to its left.
    std::optional<float> environment_rotation;
    std::optional<float> environment_scale;  ///< of the infinite lights, above 0
    std::vector<LampDescription> lamps;      ///< to be added, without area lights
    /// Least focal distance and f-number: smaller ones ask for lenses that single precision cannot
    /// hold.
    static constexpr double kLeastOfLens = 1e-9;
};

/// Applies all of them, and completes the scene (scene/defaults.h). Throws Error(usage) for a crop
/// outside the frame, a camera that looks nowhere, and for a rotation or scale of infinite lights
/// that aren't there; Error(limit) for sizes that no machine holds.
void apply(const SceneOverrides& overrides, SceneDescription& scene);

/// The pixels that a description asks for: its crop window or pixel bounds within the frame.
PixelBounds render_region(const FilmDescription& film);

}  // namespace covtrace
