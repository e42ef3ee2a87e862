/// How many samples each pixel gets: relative densities from the prediction, and exact budgets.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner/covariance_buffer.h"

namespace covtrace {

enum class DensityRule {
    tempered,  ///< n ~ sqrt( sqrt(det S2D) min(N_int, 4) ), a tenth of it shared out evenly
    thesis     ///< n ~ sqrt(det S2D) N_int, equation 5.3 of the thesis read as a Schur complement
};

/// Relative densities with mean 1, one per pixel. The spectra are first limited to what filters of
/// width factor `c` and the given limits can use (covariance::limit_spectrum), so that no pixel
/// asks for detail that the narrowest filter would remove.
std::vector<float> relative_density(const Prediction& prediction, DensityRule rule, float c,
                                    const covariance::FilterLimits<float>& limits);

/// Sample counts with the given total, as near to `total / pixels * density` as `at_least` (per
/// pixel, what has been taken already) and `at_most` (one number) allow. The sum is exactly `total`
/// where the limits allow it, else as near to it as they do. Fractions are carried along the rows.
std::vector<uint32_t> allocate(std::span<const float> density, int64_t total,
                               std::span<const uint32_t> at_least, uint32_t at_most);

/// The same, but what is left of `total` goes where most is missing. Of the samples that a density
/// asks for, N = total / pixels * density, a pixel that has n lacks N - n: the largest lacks are
/// brought down to one level, those below it get nothing. `at_most` is what one call may add to a
/// pixel, so that repeated calls, in rounds, can go beyond it: the thesis' progressive method
/// (section 5.1.3), which samples again where the limit of samples left noise.
std::vector<uint32_t> allocate_unmet(std::span<const float> density, int64_t total,
                                     std::span<const uint32_t> have, uint32_t at_most);

}  // namespace covtrace
