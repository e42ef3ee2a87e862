#include "integrator/guides/direction_histogram.h"

#include <cmath>

namespace covtrace {

namespace {

constexpr float kPrior = 0.5f;       // points that each half is taken to hold beforehand
constexpr size_t kFewestToTell = 6;  // points of a part whose halves differ

}  // namespace

DirectionHistogram::DirectionHistogram() {
    first_.fill(0.5f);
    density_.fill(1);
}

DirectionHistogram::DirectionHistogram(std::span<SquarePoint> points) : DirectionHistogram() {
    build(points, 1, 0, {0, 0});
    spread(1, 0, 0, 0, 1);
}

/// Sets the probabilities below a node; returns the sum over its even parts of the root of energy
/// times area.
float DirectionHistogram::build(std::span<SquarePoint> points, uint32_t node, int level, Vec2 low) {
    if (points.size() < kFewestToTell || level == kLevels) {
        double sum = 0;
        for (const SquarePoint& p : points) sum += double(p.energy);
        return static_cast<float>(std::sqrt(std::ldexp(sum, -level)));
    }
    const bool along_x = level % 2 == 0;
    Vec2 upper = low;
    float& split = along_x ? upper.x : upper.y;
    split += std::ldexp(0.5f, -(level / 2));
    const auto middle = std::partition(points.begin(), points.end(), [&](const SquarePoint& p) {
        return (along_x ? p.place.x : p.place.y) < split;
    });
    const auto count = static_cast<size_t>(middle - points.begin());
    const float a = build(points.first(count), 2 * node, level + 1, low);
    const float b = build(points.subspan(count), 2 * node + 1, level + 1, upper);
    const float prior = kPrior * (a + b) / static_cast<float>(points.size());
    if (a + b > 0 && std::isfinite(a + b)) first_[node] = (a + prior) / (a + b + 2 * prior);
    return a + b;
}

/// Sets the densities of the bins below a node.
void DirectionHistogram::spread(uint32_t node, int level, uint32_t x, uint32_t y, float density) {
    if (level == kLevels) {
        density_[y * kSide + x] = density;
        return;
    }
    const bool along_x = level % 2 == 0;
    for (uint32_t half = 0; half < 2; ++half)
        spread(2 * node + half, level + 1, along_x ? 2 * x + half : x, along_x ? y : 2 * y + half,
               density * 2 * (half == 0 ? first_[node] : 1 - first_[node]));
}

}  // namespace covtrace
