/// The image of `covariance`: a film's samples through predicted filters.
#pragma once

#include "reconstruction/filter_field.h"
#include "reconstruction/filtered_image.h"
#include "render/render_state.h"

namespace covtrace {

/// Filters of both parts of the light.
struct CovarianceFilters {
    FilterField scattered;
    FilterField in_view;
    bool has_in_view = false;  ///< whether emitters are in view; else their part stays as it is
};

/// The filters that the state's covariances and the number of its samples lead to.
CovarianceFilters covariance_filters(const RenderState& state);

/// Gathers both parts of the light, each through its filters, which is all that Belcour 2012,
/// section 5.1.3, does. With FilterRule::verified where the samples say that these have less error:
/// means of the same surface by the same filters or by wider ones (guided_gather.h), or the raw
/// pixels.
FilteredImage covariance_image(const RenderState& state, const CovarianceFilters& filters);

}  // namespace covtrace
