/// What the samples of a film tell the planner.
#pragma once

#include "planner/adaptive.h"
#include "render/film.h"

namespace covtrace {

/// `spectrum`: as predicted; kept by reference. Samples of a film that does not count rays cost the
/// same everywhere.
SampleKnowledge knowledge_from(const Film& film, std::span<const covariance::Sym2<float>> spectrum);

}  // namespace covtrace
