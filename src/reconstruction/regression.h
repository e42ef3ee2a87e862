/// First-order regression of the colours on the features (Bitterli et al. 2016; Moon et al. 2014).
#pragma once

#include <span>
#include <vector>

#include "reconstruction/filter_field.h"
#include "reconstruction/half_buffer.h"

namespace covtrace {

/// Features that a fit explains the colours by. Lens and shutter leave noise in them. `filtered`:
/// freed of it, and of the details that look like it. `kept`: those of the samples themselves,
/// which know every detail, but the fit takes on the noise that they share with the colours.
enum class FeatureNoise { filtered, kept };

/// Patches that are compared to tell which pixels are alike. `colors_or_light`: pixels are alike
/// whose colours are, or whose light is, the colours over the albedo. Where a texture varies under
/// even light only the light is alike once there is little noise, and the fit explains the texture
/// by the albedo.
enum class PatchesOf { colors, colors_or_light };

/// A window of a regression: the weights of the pixels q around a centre p, from the patches of
/// colours and the shape, and the features that explain the colours.
struct RegressionWindow {
    /// Patches count as alike up to k times the noise: patch_weight(d / k^2), d of PatchDistance.
    float k = 1;
    /// Field whose Gaussian is one more factor of the weights: exp(-(q - p)^T C_p^-1 (q - p) / 2),
    /// C_p the covariance of `shape` at p times `widen`^2. Null: every pixel within the reach
    /// counts alike.
    const FilterField* shape = nullptr;
    float widen = 1;
    FeatureNoise noise = FeatureNoise::filtered;
    PatchesOf patches = PatchesOf::colors;
};

constexpr int kRegressionReach = 9;  ///< windows are 19 x 19 pixels

/// Fits the colours of `half` for every window. Around each centre p (every third pixel of every
/// third row) they are fitted by  b_0 + b_x (x_q - x_p) + b_y (y_q - y_p) + sum_i b_i (f_i(q) -
/// f_i(p)), f the features of `half` or `filtered`, with weights w_pq that come from the patches of
/// `guide`, the other half, so that the noise of a pixel does not choose its own weights. A ridge
/// keeps the fit from following noise. Every pixel then is the mean of the values that the fits
/// around it have there, weighted by w_pq; a pixel without any weight, or without samples in all of
/// its window, keeps its own colour. Colours that are linear in features and position come out
/// unchanged but for the ridge.
std::vector<ColorPlanes> regress(const HalfBuffer& half, const HalfBuffer& guide,
                                 const FeaturePlanes& filtered,
                                 std::span<const RegressionWindow> windows);

}  // namespace covtrace
