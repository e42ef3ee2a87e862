/// The search for the counts at which the plain path tracer takes the time of another method, or
/// reaches its error.
#pragma once

#include <vector>

#include "reproduce/reference.h"

namespace covtrace::reproduce {

/// A render of the path tracer, looked at after each of its rounds.
class UniformCurve {
  public:
    struct Point {
        double spp, cpu, error;
    };
    /// Renders until the count, and beyond it until the error is below `error` or `most_spp` is
    /// reached.
    UniformCurve(Workshop& workshop, LoadedScene& scene, const Reference& reference, double spp,
                 double error, double most_spp);

    const std::vector<Point>& points() const { return points_; }
    /// Samples per pixel in so many CPU seconds, from the cost of a sample.
    double spp_in(double cpu) const;
    /// Samples per pixel at which the error is so low, between the two rounds around it along the
    /// line in the logarithms. Infinite where it was not reached.
    double spp_for(double error) const;
    double cpu_per_spp() const { return cpu_per_spp_; }

  private:
    std::vector<Point> points_;
    double cpu_per_spp_ = 0;
};

/// Renders of one kind with several seeds.
struct Sampled {
    std::vector<double> error, cpu, spp;
    Timed first;  ///< render with the first seed
    double mean_error() const;
    double mean_cpu() const;
    double mean_spp() const;
};

Sampled sample(Workshop& workshop, LoadedScene& scene, const Reference& reference,
               RenderOptions options);

/// The path tracer at equal time (CPU seconds of the render, the scene being loaded) or equal
/// error. The count is searched on the curve, then corrected by renders with all seeds until it is
/// within 5 %, three times at most.
struct Match {
    Sampled uniform;
    double spp = 0;
    bool found = false;   ///< false: equal error needs more than the settings' most_spp
    double mismatch = 0;  ///< relative error of the matched quantity
};
Match match_time(Workshop& workshop, LoadedScene& scene, const Reference& reference,
                 const UniformCurve& curve, double cpu);
Match match_error(Workshop& workshop, LoadedScene& scene, const Reference& reference,
                  const UniformCurve& curve, double error);

/// Spread of ratios over the seeds: geometric mean, least and most.
struct Spread {
    double mean = 0, least = 0, most = 0;
    std::string text() const;
};
Spread ratios(const std::vector<double>& numerators, const std::vector<double>& denominators);

}  // namespace covtrace::reproduce
