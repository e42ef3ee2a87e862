#include "planner/error_goal.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

double ErrorGoal::samples(double taken, double error, double wanted) {
    if (error_ > error && taken > taken_ && error > 0)
        power_ = std::clamp(std::log(error_ / error) / std::log(taken / taken_), 0.25, 0.5);
    taken_ = taken;
    error_ = error;
    if (!(error > wanted)) return taken;
    // A little more than just enough, and no step so small that its reconstruction costs more.
    constexpr double kMargin = 0.97, kLeastStep = 1.1;
    const double factor = std::pow(error / (kMargin * wanted), 1 / power_);
    return taken * std::clamp(factor, kLeastStep, 1e6);
}

}  // namespace covtrace
