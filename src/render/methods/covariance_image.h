/// The image of `covariance`: a film's samples through predicted filters.
#pragma once

#include "reconstruction/filter_field.h"
#include "reconstruction/filtered_image.h"
#include "render/film.h"

namespace covtrace {

/// Filters of both parts of the light.
struct CovarianceFilters {
    FilterField scattered;
    FilterField in_view;
    bool has_in_view = false;  ///< whether emitters are in view; else their part stays as it is
};

/// Gathers both parts of the light, each through its filters. This is all that Belcour 2012,
/// section 5.1.3, does.
FilteredImage gathered_image(const Film& film, const CovarianceFilters& filters);

/// The gathered image, or where the samples say that these have less error, means of the same
/// surface by the same filters or by wider ones (guided_gather.h), or the raw pixels.
FilteredImage judged_image(const Film& film, const CovarianceFilters& filters);

}  // namespace covtrace
