/// Undershoot: fits that lead below the dark beside what is bright.
#pragma once

#include <vector>

#include "reconstruction/candidates.h"

namespace covtrace {

/// Cuts off light of the candidates below 0, to which first-order fits lead beside what is bright:
/// mixed with the other candidates it would leave black holes in dark places. Light is never
/// negative, except beside lamps under a pixel filter with negative lobes: where samples of the
/// halves are negative somewhere nothing is cut.
void cut_undershoot(std::vector<Candidate>& candidates, const Halves& halves);

}  // namespace covtrace
