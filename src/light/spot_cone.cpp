#include "light/spot_cone.h"

#include <algorithm>
#include <cmath>

#include "core/frame.h"

namespace covtrace {

namespace {

/// Share of a transform's squared scale that counts as roundings of single precision.
constexpr double kRounding = 1e-5;

double one_minus_cosine_of(double radians) {
    return 2 * std::sin(radians / 2) * std::sin(radians / 2);
}

double tangent(double one_minus_cosine) {
    return std::sqrt(one_minus_cosine * (2 - one_minus_cosine)) / (1 - one_minus_cosine);
}

/// Whether a transform scales all directions alike.
bool keeps_angles(const Transform& t) {
    const auto& m = t.matrix().m;
    const auto product = [&m](size_t a, size_t b) {
        return m[0][a] * m[0][b] + m[1][a] * m[1][b] + m[2][a] * m[2][b];
    };
    const double scale = (product(0, 0) + product(1, 1) + product(2, 2)) / 3;
    for (size_t a = 0; a < 3; ++a)
        for (size_t b = 0; b <= a; ++b)
            if (std::abs(product(a, b) - (a == b ? scale : 0)) > kRounding * scale) return false;
    return true;
}

float angle_between(Vec3 a, Vec3 b) {
    return std::atan2(length(cross(a, b)), dot(a, b));
}

}  // namespace

SpotCone SpotCone::from_degrees(float angle, float delta_angle, const Transform& to_world,
                                Vec3 axis) {
    const double outer = std::clamp(angle, 0.0f, 180.0f);
    // pbrt-v4 takes the cosine of the difference, so the sign of a negative one does not count.
    const double inner = std::clamp<double>(std::abs(angle - delta_angle), 0, outer);
    SpotCone cone;
    cone.axis_ = normalize(to_world.vector(axis));
    cone.inner_angle_ = static_cast<float>(inner * M_PI / 180);
    cone.outer_angle_ = static_cast<float>(outer * M_PI / 180);
    cone.inner_ = static_cast<float>(one_minus_cosine_of(inner * M_PI / 180));
    cone.outer_ = static_cast<float>(one_minus_cosine_of(outer * M_PI / 180));
    if (keeps_angles(to_world)) return cone;
    cone.unstretch_ = to_world.inverse();
    cone.axis_before_ = axis;
    cone.inner_angle_ = cone.stretched(cone.inner_angle_);
    cone.outer_angle_ = cone.stretched(cone.outer_angle_);
    return cone;
}

SpotCone SpotCone::grid(float angle, Vec3 axis) {
    constexpr double kLargestTangent = 1e6;  // that of 90 degrees is no number
    const double outer = std::clamp(angle, 0.0f, 90.0f) * M_PI / 180;
    SpotCone cone;
    cone.axis_ = axis;
    cone.inner_angle_ = cone.inner_ = 0;
    cone.outer_angle_ = static_cast<float>(outer);
    cone.outer_ = static_cast<float>(one_minus_cosine_of(outer));
    cone.is_grid_ = true;
    const double t = std::tan(outer);
    cone.grid_tangent_ = static_cast<float>(t >= 0 && t < kLargestTangent ? t : kLargestTangent);
    return cone;
}

float SpotCone::one_minus_cosine(Vec3 w) const {
    if (!unstretch_) return 0.5f * length_squared(w - axis_);
    return 0.5f * length_squared(normalize(unstretch_->vector(w)) - axis_before_);
}

double SpotCone::share(double one_minus_cosine) const {
    if (!is_grid_ && one_minus_cosine <= double(inner_)) return 1;
    if (one_minus_cosine >= double(outer_)) return 0;
    if (is_grid_) return std::max(0.0, 1 - tangent(one_minus_cosine) / double(grid_tangent_));
    const double x = (double(outer_) - one_minus_cosine) / (double(outer_) - double(inner_));
    return x * x * (3 - 2 * x);
}

float SpotCone::falloff(Vec3 w) const {
    return static_cast<float>(share(double(one_minus_cosine(w))));
}

void SpotCone::for_steps(int rings, int sectors,
                         const std::function<void(Vec3, double, double)>& use) const {
    const Frame frame = Frame::from_z(unstretch_ ? axis_before_ : axis_);
    std::optional<Transform> stretch;
    double determinant = 1;
    if (unstretch_) {
        stretch = unstretch_->inverse();
        const Vec3 x = stretch->vector({1, 0, 0}), y = stretch->vector({0, 1, 0}),
                   z = stretch->vector({0, 0, 1});
        determinant = std::abs(double(dot(cross(x, y), z)));
    }
    for (int i = 0; i < rings; ++i) {
        // Steps of equal angle near the axis, where a grid's factor has a tip
        const double x = (i + 0.5) / rings, c = double(outer_) * x * x;
        const double ring = 2 * x / rings * 2 * M_PI * double(outer_);
        const auto sine = static_cast<float>(std::sqrt(c * (2 - c)));
        const double factor = share(c);
        for (int j = 0; j < sectors; ++j) {
            const auto turn = static_cast<float>((j + 0.5) / sectors * 2 * M_PI);
            Vec3 w = frame.to_world(
                {sine * std::cos(turn), sine * std::sin(turn), static_cast<float>(1 - c)});
            double solid_angle = ring / sectors;
            if (stretch) {
                w = stretch->vector(w);
                const double l = double(length(w));
                solid_angle *= determinant / (l * l * l);
                w = w / static_cast<float>(l);
            }
            use(w, solid_angle, factor);
        }
    }
}

float SpotCone::stretched(float angle) const {
    constexpr int kSteps = 256;
    const Frame frame = Frame::from_z(axis_before_);
    const Transform stretch = unstretch_->inverse();
    const auto at = [&](int i) {
        const float turn = 2 * kPi * static_cast<float>(i) / kSteps;
        const Vec3 w = frame.to_world(
            {std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle)});
        return angle_between(stretch.vector(w), axis_);
    };
    float largest = 0, step = 0;
    for (int i = 0; i < kSteps; ++i) {
        largest = std::max(largest, at(i));
        step = std::max(step, std::abs(at(i) - at(i + 1)));
    }
    // The largest lies between two of them
    return std::min(kPi, largest + step / 2);
}

namespace {
constexpr int kRings = 128, kSectors = 128;
}

float SpotCone::solid_angle() const {
    if (unstretch_) {
        double sum = 0;
        for_steps(kRings, kSectors, [&](Vec3, double step, double f) { sum += f * step; });
        return static_cast<float>(sum);
    }
    if (!is_grid_)
        // A smoothstep in the cosine lets half of its range through
        return static_cast<float>(M_PI * (double(inner_) + double(outer_)));
    // Integral of sin (1 - tan / tan(outer)) over the angle, in closed form; its series below a
    // hundredth of a radian, where that loses digits
    const double t = double(grid_tangent_), c = 1 / std::sqrt(1 + t * t), s = t * c;
    if (s < 0.01) return static_cast<float>(M_PI / 3 * s * s);
    return static_cast<float>(2 * M_PI * (double(outer_) - (std::log((1 + s) / c) - s) / t));
}

float SpotCone::projected_solid_angle(Vec3 n) const {
    double sum = 0;
    for_steps(kRings, kSectors, [&](Vec3 w, double step, double f) {
        sum += f * step * std::max(0.0, double(dot(n, w)));
    });
    return static_cast<float>(sum);
}

float SpotCone::variance() const {
    // Half the mean squared angle to the axis over the solid angle of the cone, weighted by the
    // intensity
    double weight = 0, square = 0;
    for_steps(kRings, unstretch_ ? kSectors : 1, [&](Vec3 w, double step, double f) {
        const auto angle = double(angle_between(axis_, w));
        weight += f * step;
        square += f * step * angle * angle;
    });
    return weight > 0 ? static_cast<float>(0.5 * square / weight) : 0.0f;
}

}  // namespace covtrace
