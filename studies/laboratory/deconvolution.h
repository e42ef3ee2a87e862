/// Deconvolution: the distribution of a quantity of which only noisy measurements are known.
#pragma once

#include <span>

namespace covtrace {

/// The share of all items whose true value is above `limit` in size, from one measurement of each
/// with a known standard deviation: the part beyond the limit of the distribution that makes the
/// measurements most likely (nonparametric maximum likelihood, Kiefer and Wolfowitz 1956, by
/// expectation maximisation over a grid of values; Gaussian noise). Counting the measurements
/// beyond the limit instead would count noise as well.
///
/// `values` and `deviations` have the same length and are in units of `limit`; deviations are >= 0.
double share_beyond(std::span<const float> values, std::span<const float> deviations);

}  // namespace covtrace
