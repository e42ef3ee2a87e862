/// The lens of a camera, surface by surface, as it is traced. Lengths are in scene units, which are
/// metres where light's own units matter, as in pbrt.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/error.h"

namespace covtrace {

struct LensSurface {
    /// Positive where the centre of curvature lies behind the surface; 0: a flat stop.
    float curvature_radius = 0;
    float thickness = 0;        ///< along the axis to the next surface; the last one has none
    float index = 1;            ///< of refraction behind the surface
    float aperture_radius = 0;  ///< light farther from the axis is blocked
};

/// The shape of the aperture inside the stop's radius.
struct ApertureShape {
    enum class Kind { round, gaussian, square, pentagon, star, image };
    Kind kind = Kind::round;
    std::filesystem::path image;
    SourceLocation where;
};

struct LensDescription {
    std::vector<LensSurface> surfaces;  ///< from the scene to the film
    ApertureShape aperture;
    float film_diagonal = 0.035f;
};

/// The lens for rays next to its axis.
struct ParaxialLens {
    double focal_length = 0;
    double length = 0;                 ///< from the first surface to the last
    double front_principal_plane = 0;  ///< its distance behind the first surface
    double rear_principal_plane = 0;   ///< its distance behind the last surface
    /// Radius of the aperture stop over that of the entrance pupil, its image in front of the lens;
    /// 0 where the lens has no stop.
    double stop_per_pupil = 0;
    double widest_pupil = 0;  ///< radius of the entrance pupil with the aperture wide open

    /// Distance from the rear principal plane to the film on which things in focus are sharp, these
    /// `focus_distance` in front of the film; none where they are too near for any place of the
    /// lens between.
    std::optional<double> image_distance(double focus_distance) const;
    /// Least distance from film to object that can be in focus.
    double nearest_focus() const;
};

/// Index of the surface that is the aperture stop, the first flat one; none where there is none.
std::optional<size_t> aperture_stop(const std::vector<LensSurface>& surfaces);

/// Follows a ray that comes in next to the axis and parallel to it. The focal length is not
/// positive or not finite where the surfaces do not focus.
ParaxialLens paraxial_lens(const std::vector<LensSurface>& surfaces);

}  // namespace covtrace
