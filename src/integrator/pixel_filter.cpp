#include "integrator/pixel_filter.h"

#include <cmath>

namespace covtrace {

namespace {

float sinc(float x) {
    x *= kPi;
    return std::abs(x) < 1e-4f ? 1.0f : std::sin(x) / x;
}

/// The one-dimensional factor of the filter at `x` pixels from the centre; scale is free.
float evaluate(const FilterDescription& d, float x, float radius) {
    x = std::abs(x);
    if (x > radius) return 0;
    switch (d.kind) {
        case FilterDescription::Kind::box:
            return 1;
        case FilterDescription::Kind::triangle:
            return radius - x;
        case FilterDescription::Kind::gaussian: {
            const auto g = [&d](float v) { return std::exp(-v * v / (2 * d.sigma * d.sigma)); };
            return std::max(0.0f, g(x) - g(radius));
        }
        case FilterDescription::Kind::mitchell: {
            // Mitchell and Netravali 1988, stretched from its support of 2 to the radius.
            const float v = 2 * x / radius, b = d.b, c = d.c;
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
        a.radius = axis == 0 ? description.x_radius : description.y_radius;
        double absolute = 0, sum = 0, second = 0;
        const float width = 2 * a.radius / Axis::kCells;
        for (int i = 0; i < Axis::kCells; ++i) {
            const float x = -a.radius + (static_cast<float>(i) + 0.5f) * width;
            const float f = evaluate(description, x, a.radius);
            a.negative[size_t(i)] = f < 0;
            absolute += std::abs(f);
            sum += f;
            second += f * x * x;
            a.cdf[size_t(i) + 1] = static_cast<float>(absolute);
        }
        for (float& c : a.cdf) c = static_cast<float>(c / absolute);
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
    // Mostly none or one step, which nobody could predict; seldom more.
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
