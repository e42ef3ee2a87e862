/// A forecast of the samples that an image of a given error will need.
#pragma once

namespace covtrace {

/// Forecast that learns from the errors seen so far how fast they fall. Plain data, so that a film
/// can keep it.
struct ErrorGoal {
    double taken = 0, error = 0;  ///< samples and error of the call before; 0: there was none
    /// Exponent of the error, which falls as taken^-power: 1/2 for plain samples, less for filtered
    /// ones.
    double power = 0.4;

    /// Learns that after an average of `now` samples the error (root of a mean square) is `is`.
    /// Returns the average at which it will be at most `wanted`, or `now` where it is already. To
    /// be called with rising counts.
    double samples(double now, double is, double wanted);
};

}  // namespace covtrace
