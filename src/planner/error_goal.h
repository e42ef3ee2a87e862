/// How many samples an image of a given error will need.
#pragma once

namespace covtrace {

/// Learns from the errors seen so far how fast they fall. Plain data, so that a film can keep it.
struct ErrorGoal {
    double taken = 0, error = 0;  ///< of the call before; 0: none
    /// The error falls as taken^-power: half for plain samples, less for filtered ones.
    double power = 0.4;

    /// After an average of `now` samples the error (root of a mean square) is `is`; returns the
    /// average at which it will be at most `wanted`, or `now` where it is. Call with rising counts.
    double samples(double now, double is, double wanted);
};

}  // namespace covtrace
