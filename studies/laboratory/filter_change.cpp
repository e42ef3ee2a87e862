#include "laboratory/filter_change.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/sampler.h"
#include "core/warp.h"

namespace covtrace {

namespace {

constexpr int kSide = 5;  // pixels
constexpr size_t kPixels = size_t(kSide) * kSide;

/// Sums over half of a pixel's samples, of the pixel as it is and through the filter.
struct Sums {
    double plain = 0, filtered = 0;
    double change() const { return plain > 0 ? filtered / plain - 1 : 0; }
};

/// Columns of a matrix whose product with its transpose is the covariance.
std::array<std::array<double, 2>, 2> root_of(const covariance::Sym2<double>& s) {
    const double a = std::sqrt(std::max(s.xx, 0.0)), b = a > 0 ? s.xy / a : 0;
    return {{{a, b}, {0, std::sqrt(std::max(s.yy - b * b, 0.0))}}};
}

}  // namespace

covariance::Sym2<double> filter_of(const covariance::SymmetricMatrix5<double>& sigma) {
    return covariance::filter_covariance(
        covariance::filter_quadratic(covariance::preintegrate(sigma), 2));
}

FilterChange filter_change(const LocalField& field, const covariance::Sym2<double>& filter,
                           uint32_t samples, uint64_t seed) {
    const auto columns = root_of(filter);
    const uint32_t each = std::max(1u, samples / uint32_t(2 * kPixels));
    std::array<std::array<Sums, 2>, kPixels> sums{};
    parallel_for(int64_t(2 * kPixels), [&](int64_t task) {
        const int pixel = int(task / 2), half = int(task % 2);
        const std::array<double, 2> middle{double(pixel % kSide - kSide / 2),
                                           double(pixel / kSide - kSide / 2)};
        Sums& sum = sums[size_t(pixel)][size_t(half)];
        for (uint32_t i = 0; i < each; ++i) {
            Sampler sampler(seed, pixel, half, i);
            const Sampler::CameraSample u = sampler.camera();
            const Vec2 lens = square_to_disc(u.lens);
            const auto [z0, z1] = sampler.next_2d();
            // Draw two independent normal numbers (Box and Muller)
            const double radius = std::sqrt(-2 * std::log(std::max(1 - double(z0), 1e-12))),
                         angle = 2 * double(kPi) * double(z1);
            const double n0 = radius * std::cos(angle), n1 = radius * std::sin(angle);
            SensorOffset at{middle[0] + double(u.film.x) - 0.5, middle[1] + double(u.film.y) - 0.5,
                            lens.x, lens.y, double(u.time) - 0.5};
            const auto index = uint32_t(task) * each + i;
            const double plain = field(at, index);
            for (size_t k = 0; k < 2; ++k) at[k] += columns[0][k] * n0 + columns[1][k] * n1;
            const double filtered = field(at, index);
            if (!std::isfinite(plain + filtered)) continue;
            sum.plain += plain;
            sum.filtered += filtered;
        }
    });
    FilterChange result;
    double square = 0, noise = 0;
    for (const auto& [a, b] : sums) {
        // The product of two independent halves keeps the squared noise out.
        square += a.change() * b.change() / double(kPixels);
        const double difference = 0.5 * (a.change() - b.change());
        noise += difference * difference / double(kPixels);
    }
    result.change = std::sqrt(std::max(square, 0.0));
    result.noise = std::sqrt(noise);
    return result;
}

}  // namespace covtrace
