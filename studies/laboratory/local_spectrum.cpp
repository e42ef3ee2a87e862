#include "laboratory/local_spectrum.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "core/sampler.h"
#include "laboratory/covariance_eigen.h"

namespace covtrace {

namespace {

using Matrix = covariance::SymmetricMatrix5<double>;

constexpr double kFourPiSq = 4 * double(kPi) * double(kPi);
constexpr double kFilterSharpness = 2;  // c
constexpr size_t kBatches = 8;          // even, for two halves
constexpr int kIterations = 16;
/// Share of the widest window at which the window starts: narrower than any filter.
constexpr double kNarrowest = 1.0 / 300;
/// Most and least factor of the inverse of the window's covariance in one step. The window grows at
/// most twofold and shrinks at most fourfold at a time: far from its fixed point a single step
/// tells little.
constexpr double kWiden = 0.25, kNarrow = 16;

/// The quantile of the normal distribution, by Newton's method on its tail.
double normal_quantile(double p) {
    p = std::clamp(p, 1e-12, 1 - 1e-12);
    double z = (std::pow(p, 0.135) - std::pow(1 - p, 0.135)) / 0.1975;
    for (int i = 0; i < 3; ++i) {
        const double error = 0.5 * std::erfc(-z / std::sqrt(2.0)) - p;
        z -= error * std::sqrt(2 * double(kPi)) * std::exp(0.5 * z * z);
    }
    return z;
}

/// Sums of the field times Hermite polynomials up to the third order.
struct HermiteSums {
    uint64_t count = 0;
    double sum = 0;
    Matrix second;
    std::array<Matrix, 5> third;  ///< entry (i, j, k) is third[k](i, j)

    void add(double g, const std::array<double, 5>& z, const std::array<bool, 5>& axes) {
        ++count;
        sum += g;
        for (size_t i = 0; i < 5; ++i)
            for (size_t j = i; j < 5; ++j) {
                if (!axes[i] || !axes[j]) continue;
                const double he2 = z[i] * z[j] - (i == j);
                second(i, j) += g * he2;
                for (size_t k = 0; k < 5; ++k)
                    if (axes[k])
                        third[k](i, j) += g * (he2 * z[k] - (i == k) * z[j] - (j == k) * z[i]);
            }
    }
    void add(const HermiteSums& o) {
        count += o.count;
        sum += o.sum;
        second = second + o.second;
        for (size_t k = 0; k < 5; ++k) third[k] = third[k] + o.third[k];
    }
};
using Batches = std::array<HermiteSums, kBatches>;

/// The window as a linear map: offset = sum_k z_k axis_k, axes orthogonal.
struct Window {
    /// Eigenvalues and eigenvectors of the inverse covariance. Axes that are not looked at stay
    /// their own eigenvectors, in place.
    SymmetricEigen<5> precision;

    SensorOffset offset(const std::array<double, 5>& z) const {
        SensorOffset p{};
        for (size_t k = 0; k < 5; ++k)
            for (size_t i = 0; i < 5; ++i)
                p[i] += z[k] / std::sqrt(precision.values[k]) * precision.vectors[k][i];
        return p;
    }
    /// The symmetric form that has the matrix l in whitened coordinates.
    Matrix unwhiten(const Matrix& l) const {
        covariance::Matrix5<double> whitening;  // gives z from the offset
        for (size_t k = 0; k < 5; ++k)
            for (size_t i = 0; i < 5; ++i)
                whitening(k, i) = std::sqrt(precision.values[k]) * precision.vectors[k][i];
        return covariance::transform(l, whitening);
    }
    double deviation(size_t axis) const {
        double variance = 0;
        for (size_t k = 0; k < 5; ++k)
            variance += sqr(precision.vectors[k][axis]) / precision.values[k];
        return std::sqrt(variance);
    }
};

Batches sample_window(const LocalField& field, const Window& window, uint32_t samples,
                      const MeasureOptions& o) {
    constexpr uint32_t kChunk = 512;
    const uint32_t chunks = std::max(1u, samples / uint32_t(kBatches) / kChunk);
    std::vector<HermiteSums> sums(kBatches * chunks);
    parallel_for(int64_t(sums.size()), [&](int64_t c) {
        const auto batch = uint64_t(c) / chunks;
        for (uint32_t i = 0; i < kChunk; ++i) {
            // Every batch is a point set of its own, so that the batches are independent.
            const uint32_t in_batch = uint32_t(uint64_t(c) % chunks) * kChunk + i;
            Sampler sampler(o.seed, int(batch), 0, in_batch);
            const Sampler::CameraSample u = sampler.camera();
            const std::array<double, 5> z{normal_quantile(u.film.x), normal_quantile(u.film.y),
                                          normal_quantile(u.lens.x), normal_quantile(u.lens.y),
                                          normal_quantile(u.time)};
            const double g = field(window.offset(z), uint32_t(batch) * chunks * kChunk + in_batch);
            if (std::isfinite(g)) sums[size_t(c)].add(g, z, o.axes);
        }
    });
    Batches batches;
    for (size_t c = 0; c < sums.size(); ++c) batches[c / chunks].add(sums[c]);
    return batches;
}

/// The symmetric product ½ (a b + b a).
Matrix symmetric_product(const Matrix& a, const Matrix& b) {
    Matrix r;
    for (size_t i = 0; i < 5; ++i)
        for (size_t j = i; j < 5; ++j)
            for (size_t k = 0; k < 5; ++k) r(i, j) += 0.5 * (a(i, k) * b(k, j) + b(i, k) * a(k, j));
    return r;
}

/// The matrix 4 pi^2 Sigma in whitened coordinates. Squares are products of two independent halves,
/// which keeps the squared noise out; the batch `left_out` counts in neither.
Matrix whitened_bandwidth(const Batches& batches, size_t left_out = kBatches) {
    std::array<HermiteSums, 2> half;
    for (size_t b = 0; b < kBatches; ++b)
        if (b != left_out) half[b % 2].add(batches[b]);
    if (!(half[0].sum > 0) || !(half[1].sum > 0)) return {};
    std::array<Matrix, 2> second;
    for (size_t h = 0; h < 2; ++h)
        second[h] = map_eigenvalues((1 / half[h].sum) * half[h].second,
                                    [](double l) { return l < 0 ? l / std::max(1 + l, 1e-3) : l; });
    Matrix square = symmetric_product(second[0], second[1]);
    for (size_t k = 0; k < 5; ++k)
        square = square + symmetric_product((1 / half[0].sum) * half[0].third[k],
                                            (1 / half[1].sum) * half[1].third[k]);
    return map_eigenvalues(square, [](double l) { return std::sqrt(std::max(l, 0.0)); });
}

double bandwidth(const Matrix& sigma, size_t axis) {
    return std::sqrt(std::max(0.0, sigma(axis, axis)));
}

/// The result in the sensor's units, and its error by the jackknife.
MeasuredSpectrum evaluate(const Window& window, const Batches& batches) {
    MeasuredSpectrum result;
    const auto sigma_without = [&](size_t left_out) {
        return (1 / kFourPiSq) * window.unwhiten(whitened_bandwidth(batches, left_out));
    };
    result.sigma = sigma_without(kBatches);
    for (const HermiteSums& b : batches) result.mean += b.sum / (double(b.count) * kBatches);
    std::array<Matrix, kBatches> without;
    for (size_t b = 0; b < kBatches; ++b) without[b] = sigma_without(b);
    for (size_t axis = 0; axis < 5; ++axis) {
        result.window[axis] = window.deviation(axis);
        double mean = 0, spread = 0;
        for (const Matrix& s : without) mean += bandwidth(s, axis) / kBatches;
        for (const Matrix& s : without) spread += sqr(bandwidth(s, axis) - mean);
        result.bandwidth_error[axis] = std::sqrt(spread * (kBatches - 1) / kBatches);
    }
    return result;
}

}  // namespace

bool is_resolved(double variance, size_t axis, const MeasureOptions& o) {
    const double widest = axis < 2 ? o.widest_pixels : axis < 4 ? o.widest_lens : o.widest_shutter;
    return kFourPiSq * sqr(kFilterSharpness * widest) * variance > 1;
}

MeasuredSpectrum measure(const LocalField& field, const MeasureOptions& o) {
    const std::array<double, 5> deviations{o.widest_pixels, o.widest_pixels, o.widest_lens,
                                           o.widest_lens, o.widest_shutter};
    Matrix widest, precision;
    for (size_t axis = 0; axis < 5; ++axis) {
        widest(axis, axis) = 1 / sqr(deviations[axis]);
        precision(axis, axis) = widest(axis, axis) / sqr(kNarrowest);
    }
    Window window;
    for (int i = 0; i < kIterations; ++i) {
        window = {covariance_eigen(precision)};
        const Matrix l =
            whitened_bandwidth(sample_window(field, window, o.samples / kIterations, o));
        precision = widest + window.unwhiten(map_eigenvalues(l, [](double e) {
            return std::clamp(sqr(kFilterSharpness) * e, kWiden, kNarrow);
        }));
    }
    window = {covariance_eigen(precision)};
    return evaluate(window, sample_window(field, window, o.samples, o));
}

}  // namespace covtrace
