/// The gather led by what is seen first: Gaussian means of the pixels around that show the same
/// surface, of light without its texture, and of light as it is.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "reconstruction/filter_field.h"
#include "reconstruction/filtered_image.h"

namespace covtrace {

/// Features of what is seen first, their noise filtered.
struct FilterGuides {
    std::vector<Rgb> albedo;
    std::vector<Rgb> normal;          ///< x, y, z as r, g, b
    std::vector<float> log_distance;  ///< natural logarithm of the distance from the camera
};

/// The scales of the filters' deviations by which guided candidates are gathered.
constexpr std::array kGuidedScales{1.0f, 2.0f, 4.0f};

/// Widest deviation in pixels, the root of half the trace, of a scaled filter: every pixel within
/// three of them is looked at.
constexpr float kWidestScaled = 5;

/// A filter's covariance at a scale of kGuidedScales, no wider than kWidestScaled.
covariance::Sym2<float> scaled_filter(const covariance::Sym2<float>& filter, float scale);

/// Two candidates for each of kGuidedScales,
///     I(p) = a(p) sum_q h(q - p) g(p, q) m(q) / a(q) / sum_q h(q - p) g(p, q),
/// h the scaled Gaussian of pixel p cut at 3 standard deviations, m the pixel means, a the guides'
/// albedo (0.02 or more by channel), and g a Gaussian of the guides' differences; and the same with
/// a = 1. A texture on a diffuse surface is a factor of its light and passes whole in the first;
/// what a coat reflects is not coloured by what lies below it, and has its brightness in the
/// second. A pixel that shows another surface takes no part. Pixels without samples (count 0) and
/// non-finite means take no part either. Where nothing is left to gather, a candidate has the
/// colour 0 and an infinite variance.
///
/// `mean`, `variance` (of the mean's luminance), `count` and the guides have one entry per pixel of
/// the field.
std::vector<FilteredImage> guided_gather(std::span<const Rgb> mean, std::span<const float> variance,
                                         std::span<const uint32_t> count, const FilterField& field,
                                         const FilterGuides& guides);

}  // namespace covtrace
