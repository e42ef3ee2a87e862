/// The planner's knowledge of a pixel, from the samples of a film.
#pragma once

#include "planner/adaptive.h"
#include "render/film.h"

namespace covtrace {

/// Makes the knowledge that the planner works with. `spectrum` is the predicted one, kept by
/// reference. The variance of luminance takes the channels for fully correlated; it is 0 in pixels
/// with fewer than two samples. A sample costs the rays it took; in a film that does not count rays
/// samples cost the same everywhere.
SampleKnowledge knowledge_from(const Film& film, std::span<const covariance::Sym2<float>> spectrum);

}  // namespace covtrace
