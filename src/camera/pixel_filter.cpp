#include "camera/pixel_filter.h"

#include <cmath>

namespace covtrace {

namespace {

double sinc(double x) {
    x *= kPi;
    return std::abs(x) < 1e-4 ? 1.0 : std::sin(x) / x;
}

/// Distance from the centre beyond which the filter is as good as 0: cells beyond would make the
/// others coarse.
double support(const FilterDescription& d, double radius) {
    constexpr double kGaussianEnd = 6;  // deviations, where it is 1.5e-8 of its peak
    const bool is_gaussian = d.kind == FilterDescription::Kind::gaussian;
    return is_gaussian ? std::min(radius, kGaussianEnd * d.sigma) : radius;
}

/// The one-dimensional factor of the filter at `x` pixels from the centre; its scale is free.
/// Computed in double, since filters much narrower than a pixel are differences of numbers that are
/// all but equal.
double evaluate(const FilterDescription& d, double x, double radius) {
    x = std::abs(x);
    if (x > radius) return 0;
    switch (d.kind) {
        case FilterDescription::Kind::box:
            return 1;
        case FilterDescription::Kind::triangle:
            return radius - x;
        case FilterDescription::Kind::gaussian: {
            // The difference exp(a) - exp(b) is exact for a and b near each other, too.
            const double s = 1 / (2 * double(d.sigma) * d.sigma);
            return -std::exp(-x * x * s) * std::expm1((x - radius) * (x + radius) * s);
        }
        case FilterDescription::Kind::mitchell: {
            // The filter is that of Mitchell and Netravali 1988, stretched from its support of 2 to
            // the radius.
            const double v = 2 * x / radius, b = d.b, c = d.c;
            if (v <= 1)
                return ((12 - 9 * b - 6 * c) * v * v * v + (-18 + 12 * b + 6 * c) * v * v +
                        (6 - 2 * b)) /
                       6;
            return ((-b - 6 * c) * v * v * v + (6 * b + 30 * c) * v * v + (-12 * b - 48 * c) * v +
                    (8 * b + 24 * c)) /
                   6;
        }
        case FilterDescription::Kind::lanczos_sinc:
            return sinc(x) * sinc(x / d.tau);
    }
    return 0;
}

}  // namespace

PixelFilter::PixelFilter(const FilterDescription& description) {
    for (int axis = 0; axis < 2; ++axis) {
        Axis& a = axis == 0 ? x_ : y_;
        const double radius = axis == 0 ? description.x_radius : description.y_radius;
        const double end = support(description, radius);
        a.radius = static_cast<float>(end);
        double absolute = 0, sum = 0, second = 0;
        std::array<double, Axis::kCells + 1> cumulative{};
        for (int i = 0; i < Axis::kCells; ++i) {
            const double x = end * ((i + 0.5) * 2 / Axis::kCells - 1);
            const double f = evaluate(description, x, radius);
            a.negative[size_t(i)] = f < 0;
            absolute += std::abs(f);
            sum += f;
            second += f * x * x;
            cumulative[size_t(i) + 1] = absolute;
        }
        for (size_t i = 0; i < cumulative.size(); ++i)
            a.cdf[i] = static_cast<float>(cumulative[i] / absolute);
        a.cdf.back() = 1;
        for (size_t k = 0, cell = 0; k < Axis::kCells; ++k) {
            while (a.cdf[cell + 1] <= static_cast<float>(k) / Axis::kCells) ++cell;
            a.first[k] = static_cast<uint16_t>(cell);
        }
        a.weight = static_cast<float>(absolute / sum);
        (axis == 0 ? variance_.x : variance_.y) = static_cast<float>(second / sum);
    }
}

std::array<float, 2> PixelFilter::Axis::sample(float u) const {
    size_t cell = first[static_cast<size_t>(u * kCells)];
    // The search takes mostly none or one step, which nobody could predict; seldom more.
    cell += cdf[cell + 1] <= u ? 1 : 0;
    while (cdf[cell + 1] <= u) ++cell;
    const float span = cdf[cell + 1] - cdf[cell];
    const float within = span > 0 ? (u - cdf[cell]) / span : 0.5f;
    const float offset = -radius + (static_cast<float>(cell) + within) * (2 * radius / kCells);
    return {offset, negative[cell] ? -weight : weight};
}

PixelFilter::Sample PixelFilter::sample(Vec2 u) const {
    const auto [x, wx] = x_.sample(u.x);
    const auto [y, wy] = y_.sample(u.y);
    return {{x, y}, wx * wy};
}

}  // namespace covtrace
