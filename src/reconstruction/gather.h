/// The gather: every pixel is a Gaussian mean of the pixels around it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"
#include "reconstruction/filter_field.h"
#include "reconstruction/filtered_image.h"
#include "reconstruction/half_buffer.h"

namespace covtrace {

/// The gathered image I(p) = sum_i h_p(i - p) m_i / sum_i h_p(i - p) over the pixel means m_i, h_p
/// the Gaussian of pixel p cut at 3 standard deviations. Pixels without samples (count 0) and
/// non-finite means take no part; a pixel with nothing to gather from gets a wider filter until it
/// has. Wide filters read box-averaged copies of the image whose pixels are at most half of the
/// narrow axis' deviation wide.
///
/// `mean`, `variance` (of the mean's luminance) and `count` have field.width * field.height
/// entries. Pixels gather, they never splat: no result depends on threads. Variances are
/// sum h^2 var / (sum h)^2.
FilteredImage gather(std::span<const Rgb> mean, std::span<const float> variance,
                     std::span<const uint32_t> count, const FilterField& field);

/// Planes of features that are gathered beside the light.
inline constexpr size_t kGatheredFeatures = 7;

/// The same, and the same means of `features`, which take the place of the features: the weights,
/// most of the work, are those of the light. Features are finite, and as large as the field.
FilteredImage gather(std::span<const Rgb> mean, std::span<const float> variance,
                     std::span<const uint32_t> count, const FilterField& field,
                     std::span<Plane, kGatheredFeatures> features);

/// Gathers the colours of both halves, which share the filters and so their weights.
std::array<ColorPlanes, 2> gather(const Halves& halves, const FilterField& field);

}  // namespace covtrace
