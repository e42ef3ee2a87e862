/// How many samples each pixel gets: relative densities from the prediction, and exact budgets.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/plane.h"
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

/// What `rule` asks for beyond the tempered density, (g / g_tempered)^0.7, as a mean over a few
/// pixels since a few paths tell it with much noise: SampleKnowledge::emphasis (docs/decisions/0062
/// has the sweep of the exponent). One in every pixel for the tempered rule itself.
Plane emphasis(const Prediction& prediction, DensityRule rule, float c,
               const covariance::FilterLimits<float>& limits);

/// Sample counts with the given total, as near to `total / pixels * density` as `at_least` (per
/// pixel, what has been taken already) and `at_most` (one number) allow. The sum is exactly `total`
/// where the limits allow it, else as near to it as they do. Fractions are carried along the rows.
std::vector<uint32_t> allocate(std::span<const float> density, int64_t total,
                               std::span<const uint32_t> at_least, uint32_t at_most);

/// The same, but `at_most` is what one call may add to a pixel, so that repeated calls, in rounds,
/// go beyond it and sample again where the limit of samples left noise: the thesis' progressive
/// method (section 5.1.3).
std::vector<uint32_t> allocate_on_demand(std::span<const float> density, int64_t total,
                                         std::span<const uint32_t> have, uint32_t at_most);

}  // namespace covtrace
