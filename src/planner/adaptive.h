/// Adaptive plans: the next samples go where they lower the error of the reconstructed image most.
#pragma once

#include <span>
#include <vector>

#include "core/plane.h"
#include "covariance/covariance.hpp"

namespace covtrace {

/// Knowledge of every pixel, row by row.
struct SampleKnowledge {
    Plane brightness;                                   ///< mean luminance
    Plane variance;                                     ///< variance of the luminance of one sample
    Plane cost;                                         ///< rays of one sample; below 1 counts as 1
    std::span<const covariance::Sym2<float>> spectrum;  ///< predicted spectrum, (cycles/pixel)^2
    /// Factor of the counts, where a density rule wants others than those that lower the error of
    /// the image most (planner/density.h); only its ratios matter. Empty: the same for all.
    Plane emphasis;
};

/// Settings of a plan: whose samples it is for, and what will be made of them.
struct PlanSettings {
    /// Whether the counts are for the very sequence of samples that is known, not for another one.
    bool own;
    float dark_squared;    ///< eps of adaptive_density, where the image is exposed for a display
    float widest_filter;   ///< deviation of the widest filter that smooths the samples, pixels
    float spectrum_power;  ///< exponent of |S_2D|
};

/// Settings for the predicted Gaussians, as the derivation below gives them.
constexpr PlanSettings kOwnPlan{true, 0.01f, 15, 0.25f};
/// Settings for two halves that plan for each other, and regressions, which leave no less noise
/// than a Gaussian of some 2 pixels does: as found by a sweep (docs/decisions/0093).
constexpr PlanSettings kHalvesPlan{false, 0.1f, 2, 0.2f};

/// The eps for an image of this brightness: smaller where all of it is dim
/// (core/display_exposure.h).
float dark_squared(const PlanSettings& settings, const Plane& brightness);

/// Makes relative densities with mean 1; where all would be 0, each is 1.
///
/// A filter F_p = sum_q a_pq y_q of pixels' means y_q has the variance sum_q a_pq^2 sigma_q^2 /
/// n_q; the counts that minimise the sum over p of g_p times it, g = 1 / (I^2 + eps), at a given
/// total cost are
///     n_q ~ sigma_q sqrt(A_q / c_q),   A_q = sum_p g_p a_pq^2.
/// For the predicted Gaussian, whose squares sum to 1 / (4 pi sqrt|C|) ~ sqrt|S_2D|,
///     n ~ sigma |S_2D|^(1/4) / (sqrt(I^2 + eps) sqrt(c)).
/// Few samples know little of sigma / I and of c: the square of the one and the other are averaged
/// over a few pixels. Where light is rare, a pixel that has seen some gets more samples and sees
/// more: counts that follow their own samples, or, through several rounds, those of another half
/// that followed them, make the image too dark, the more so the fewer pixels the average is over
/// (docs/decisions/0093). For own samples sigma / I itself is averaged.
std::vector<float> adaptive_density(const SampleKnowledge& known, const PlanSettings& settings);

/// Scales densities to mean 1; those that are not finite count as 0. Where all would be 0, each is
/// 1.
std::vector<float> scaled_to_mean_one(std::vector<float> density);

/// Knowledge of every pixel behind its filter, row by row.
struct FilteredKnowledge {
    Plane brightness;  ///< luminance of the filtered image
    Plane variance;    ///< variance of that luminance; not read where `count` is below 2
    Plane count;       ///< samples that the pixel has
};

/// Makes relative densities with mean 1 from the noise that filters have left, and from `predicted`
/// ones; where all would be 0, each is 1.
///
/// Where filters hardly change from pixel to pixel, the variance V_q of the filtered image is
/// sigma_q^2 / n_q sum_p a_qp^2, so that the counts of adaptive_density are
///     n ~ sqrt(n_q V_q / (I^2 + eps)),
/// whatever filters the image has, and however much of a texture they keep. The square is the
/// larger of an average over a few pixels and half of one over twice as many across: where light is
/// rare, pixels that have seen some would else get the samples of those that have not, and its mean
/// would sink further. Pixels with fewer than two samples take no part in averages; where there is
/// nothing else, the predicted density stands alone. As few samples tell V with much noise of its
/// own, the density elsewhere is a weighted geometric mean of this one and the predicted one.
std::vector<float> density_of_noise_left(const FilteredKnowledge& known,
                                         std::span<const float> predicted);

/// Gives `share` of all samples out evenly. Pre: densities with mean 1.
void spread_evenly(std::span<float> density, float share);

}  // namespace covtrace
