/// Undershoot: fits that lead below the dark beside what is bright. Light is never negative, except
/// beside lamps under a pixel filter with negative lobes: within the reach of a fit around negative
/// samples nothing is cut.
#pragma once

#include <span>

#include "reconstruction/candidates.h"
#include "reconstruction/selector.h"

namespace covtrace {

/// A guess without its light below 0.
ColorPlanes without_undershoot(ColorPlanes guess, const Halves& halves);

/// Gives the mixture of each half, where it is below 0, the light of the darkest candidate that is
/// not: a hole of 0 would be seen in dark places. Candidates without a share count, too: the only
/// one with a share that is above 0 may be a fit that leads far above the dark, with a share of a
/// thousandth, and would be seen as a bright speck. Candidates stay as they are before they are
/// mixed: what fits lack beside bright things balances what others have too much.
void fill_undershoot(std::span<const Candidate> candidates, const Halves& halves, Selection& s);

}  // namespace covtrace
