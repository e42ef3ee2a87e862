/// How many samples an image of a given error will need.
#pragma once

namespace covtrace {

/// Learns from the errors seen so far how fast they fall.
class ErrorGoal {
  public:
    /// After an average of `taken` samples the error (root of a mean square) is `error`; returns
    /// the average at which it will be at most `wanted`, or `taken` where it is. Call with rising
    /// counts.
    double samples(double taken, double error, double wanted);

  private:
    double taken_ = 0, error_ = 0;  // of the call before; 0: none
    double power_ =
        0.4;  // the error falls as taken^-power: half for plain samples, less for filtered
};

}  // namespace covtrace
