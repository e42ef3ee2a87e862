#include "planner/error_goal.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

double ErrorGoal::samples(double now, double is, double wanted) {
    if (error > is && now > taken && is > 0)
        power = std::clamp(std::log(error / is) / std::log(now / taken), 0.25, 0.5);
    taken = now;
    error = is;
    if (!(is > wanted)) return now;
    // The step aims at a little more than just enough, and none is so small that its reconstruction
    // costs more.
    constexpr double kMargin = 0.97, kLeastStep = 1.1;
    const double factor = std::pow(is / (kMargin * wanted), 1 / power);
    return now * std::clamp(factor, kLeastStep, 1e6);
}

}  // namespace covtrace
