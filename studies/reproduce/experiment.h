/// The experiments of the thesis' section 5.1.
#pragma once

#include "reproduce/section.h"
#include "reproduce/workshop.h"

namespace covtrace::reproduce {

/// Figure 5.6: filters under a small and a large lens.
Section lens(Workshop& workshop);
/// Figure 5.7: filters of a moving checkerboard.
Section motion(Workshop& workshop);
/// Figure 5.8: filters of highlights from sharp to broad.
Section shininess(Workshop& workshop);
/// Figures 5.9 and 5.10: the snooker table.
Section snooker(Workshop& workshop);
/// Figure 5.11: the helicopter.
Section helicopter(Workshop& workshop);
/// Table 5.1: times at equal quality.
Section table(Workshop& workshop);
/// Figure 5.12: the grid's width, and the query of the geometry.
Section voxels(Workshop& workshop);
/// Section 5.1.3: sampling again where the limit of samples left noise.
Section progressive(Workshop& workshop);
/// Figure 5.1: from the covariance to the image; equation 5.7.
Section pipeline(Workshop& workshop);

}  // namespace covtrace::reproduce
