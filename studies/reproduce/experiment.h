/// The experiments of Belcour 2012, section 5.1. Figures, tables and equations are numbered as
/// there.
#pragma once

#include "reproduce/section.h"
#include "reproduce/workshop.h"

namespace covtrace::reproduce {

/// Experiment on space, time and the shutter (figures before 5.6).
Section slice(Workshop& workshop);
/// Experiment on combs of samples and their replicas (figures before 5.6).
Section sampling(Workshop& workshop);
/// Experiment on filters under a small and a large lens (figure 5.6).
Section lens(Workshop& workshop);
/// Experiment on filters of a moving checkerboard (figure 5.7).
Section motion(Workshop& workshop);
/// Experiment on filters of highlights from sharp to broad (figure 5.8).
Section shininess(Workshop& workshop);
/// Experiment on the snooker table (figures 5.9 and 5.10).
Section snooker(Workshop& workshop);
/// Experiment on the helicopter (figure 5.11).
Section helicopter(Workshop& workshop);
/// Experiment on times at equal quality (table 5.1).
Section table(Workshop& workshop);
/// Experiment on the grid's width, and the query of the geometry (figure 5.12).
Section voxels(Workshop& workshop);
/// Experiment on sampling again where the limit of samples left noise (section 5.1.3).
Section progressive(Workshop& workshop);
/// Experiment on the way from the covariance to the image (figure 5.1, equation 5.7).
Section pipeline(Workshop& workshop);

}  // namespace covtrace::reproduce
