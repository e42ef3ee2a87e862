/// The description of one pixel by all that an image knows of it, with units and in words.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/pixel_certainty.h"
#include "image/image.h"

namespace covtrace::cli {

/// Principal axes of a symmetric 2x2 matrix: square roots of its eigenvalues, and the direction of
/// the longer axis in degrees in (-90, 90], counter-clockwise on the screen from the direction of
/// x.
struct PrincipalAxes {
    double major = 0, minor = 0, angle = 0;
};
/// Finds the axes; `y` points down on the screen.
PrincipalAxes principal_axes(double xx, double xy, double yy);

/// One axis of the local light field: standard deviation of its spectrum. The lens axes count over
/// the whole aperture, which is two of the radii that the covariance counts in
/// (covariance/README.md).
struct AxisBandwidth {
    std::string name;  ///< "image x", "image y", "lens x", "lens y", "time"
    std::string unit;  ///< "cycles/pixel", "cycles/aperture", "cycles/shutter"
    double value = 0;
    std::string words;  ///< meaning of the value, such as "one period in 4 pixels"
};

/// The count N = k pi sqrt|S + W| of samples in one pixel (Belcour 2012, section 5.1,
/// equation 5.3): S is the pixel's covariance, W that of the windows of lens and shutter, without
/// which one constant axis would make the count vanish. Both count per lens radius, of which an
/// aperture of unit area has 1/sqrt(pi): hence pi (covariance::hypercube_density).
struct HypercubeCount {
    double density = 0;       ///< pi sqrt|S + W| per unit hypercube: pixel x aperture x shutter
    std::optional<double> k;  ///< absent where the image was not planned by this density
};

/// The part of a pixel that one kind of candidate made, from the layer `share`.
struct CandidateShare {
    std::string kind, title;  ///< the channel's name, and the kind for people
    double share = 0;         ///< from 0 to 1
};

struct PixelDescription {
    int x = 0, y = 0;
    std::vector<std::pair<std::string, float>> values;  ///< all but those of `covariance`
    /// Covariance over (pixel x, pixel y, lens radius x, lens radius y, shutter); absent without
    /// the 15 channels of cov.
    std::optional<std::array<std::array<float, 5>, 5>> covariance;
    std::vector<AxisBandwidth> bandwidth;  ///< empty without covariance
    bool found_light = true;  ///< false: no path of the analysis found any, and cov is 0
    std::optional<PrincipalAxes> spectrum;    ///< cycles/pixel, after lens and shutter
    std::optional<PrincipalAxes> filter;      ///< standard deviations in pixels
    std::optional<HypercubeCount> hypercube;  ///< from `covariance`
    /// Samples taken, samples that the last plan asked for, and estimated standard error of the
    /// luminance; each absent without its layer.
    std::optional<float> samples, density, error;
    std::optional<PixelCertainty> certainty;  ///< absent without the layer `error`
    std::vector<CandidateShare> shares;       ///< empty but for images of `hybrid`
};

/// Describes a pixel by the layers that have the project's own names. Throws Error(usage) where the
/// pixel is outside the data window.
PixelDescription describe_pixel(const Image& image, int x, int y);

/// The description in lines of text, of which the last ends with a line break.
std::string to_text(const PixelDescription& pixel);
/// The description as one JSON object; values that are not finite are null.
nlohmann::json to_json(const PixelDescription& pixel);

/// A number with four significant digits; powers of ten below 1e-4 and from 1e5 on.
std::string format_number(double value);

}  // namespace covtrace::cli
