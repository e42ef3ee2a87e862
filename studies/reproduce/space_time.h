/// Slices of the camera's light field in space and time: what a row of pixels sees before, while
/// and after the shutter is open, and the covariances of its spectrum.
#pragma once

#include "integrator/render_scene.h"
#include "reproduce/grid_spectrum.h"

namespace covtrace::reproduce {

/// A slice: columns are pixels, rows are times. It shows kIntervals shutter intervals of kSlots
/// rows, the middle one being the image's.
inline constexpr int kSlots = 32, kIntervals = 3;

/// The luminance that the pixels of an image's row see, by real paths through the film's filter.
/// The scene's shutter is open for all kIntervals.
Grid light_field(const RenderScene& scene, std::array<int, 2> size, int row, uint64_t seed);

/// The slice while the shutter is open; 0 before and after.
Grid while_open(const Grid& slice);

/// The mean over the middle interval, which comes through the shutter: one row.
Grid integrated(const Grid& slice);

/// One row of a slice.
Grid moment(const Grid& slice, int slot);

/// The grid's deviations from its mean in a window (windowed).
Grid without_mean(const Grid& grid, std::array<double, 2> window);

/// A covariance of amplitudes over image and time, (cycles per pixel, cycles per shutter interval),
/// and that of the image behind the shutter.
struct SpaceTimeCovariance {
    double xx = 0, xt = 0, tt = 0, behind = 0;
    /// Way in a shutter interval, pixels: what moves with it has its spectrum along f_t = -way f_x.
    double way() const { return -xt / xx; }
};

/// The covariance that Gaussians with the measured energies have, without the windows' own share:
/// a Gaussian's amplitudes have twice the variance of its energies. `slices` are without_mean() of
/// `window`.
SpaceTimeCovariance measured_covariance(const std::vector<Grid>& slices,
                                        std::array<double, 2> window);

}  // namespace covtrace::reproduce
