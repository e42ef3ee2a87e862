#include "planner/covariance_buffer.h"

#include <algorithm>
#include <limits>

#include "core/parallel.h"

namespace covtrace {

CovarianceBuffer unpack(std::span<const PackedCovariance> packed, int width, int height) {
    CovarianceBuffer result(width, height);
    parallel_for(height, [&](int64_t row) {
        for (size_t i = size_t(row) * size_t(width), end = i + size_t(width); i < end; ++i) {
            result.covariance[i] = covariance::cast<float>(packed[i].covariance());
            result.weight[i] = packed[i].weight;
        }
    });
    return result;
}

namespace {

/// Calls visit(pixel, mean of both parts) for all pixels.
template <typename Visit>
void merge_pixels(const CovarianceBuffers& buffers, const Visit& visit) {
    parallel_for(buffers.height, [&](int64_t row) {
        const size_t width = size_t(buffers.width);
        for (size_t i = size_t(row) * width, end = i + width; i < end; ++i) {
            const PackedCovariance &a = buffers.scattered[i], &b = buffers.in_view[i];
            covariance::Accumulator<double> mean;
            mean.add(a.covariance(), a.weight);
            mean.add(b.covariance(), b.weight);
            visit(i, mean);
        }
    });
}

}  // namespace

CovarianceBuffer merge(const CovarianceBuffers& buffers) {
    CovarianceBuffer result(buffers.width, buffers.height);
    merge_pixels(buffers, [&](size_t i, const auto& mean) {
        result.covariance[i] = covariance::cast<float>(mean.mean());
        result.weight[i] = float(mean.weight());
    });
    return result;
}

std::vector<PackedCovariance> packed_merge(const CovarianceBuffers& buffers) {
    std::vector<PackedCovariance> result(buffers.scattered.size());
    merge_pixels(buffers, [&](size_t i, const auto& mean) {
        result[i] = {mean.mean(), float(mean.weight())};
    });
    return result;
}

Prediction preintegrate(const CovarianceBuffer& buffer) {
    Prediction p;
    p.width = buffer.width;
    p.height = buffer.height;
    p.spectrum.resize(buffer.covariance.size());
    p.interior_count.resize(buffer.covariance.size());
    parallel_for(buffer.height, [&](int64_t row) {
        for (int x = 0; x < buffer.width; ++x) {
            const size_t i = size_t(row) * size_t(buffer.width) + size_t(x);
            const auto s = covariance::cast<double>(buffer.covariance[i]);
            const auto [spectrum, count] = covariance::integrate_over_sensor(s);
            p.spectrum[i] = {float(spectrum.xx), float(spectrum.xy), float(spectrum.yy)};
            p.interior_count[i] = float(count);
        }
    });
    return p;
}

namespace {

/// For every pixel the index of a nearest pixel with a weight: a chamfer transform with the steps 5
/// and 7, one pass down and one up, so that the time is linear whatever the holes. At least one
/// pixel has a weight.
std::vector<size_t> nearest_lit(const CovarianceBuffer& b) {
    constexpr int kFar = std::numeric_limits<int>::max() / 2;
    std::vector<int> distance(b.weight.size(), kFar);
    std::vector<size_t> nearest(b.weight.size());
    for (size_t i = 0; i < nearest.size(); ++i) {
        nearest[i] = i;
        if (b.weight[i] > 0) distance[i] = 0;
    }
    const auto relax = [&](int x, int y, int dx, int dy, int step) {
        const int px = x + dx, py = y + dy;
        if (px < 0 || py < 0 || px >= b.width || py >= b.height) return;
        const size_t i = size_t(y) * size_t(b.width) + size_t(x);
        const size_t j = size_t(py) * size_t(b.width) + size_t(px);
        if (distance[j] + step >= distance[i]) return;
        distance[i] = distance[j] + step;
        nearest[i] = nearest[j];
    };
    for (int y = 0; y < b.height; ++y)
        for (int x = 0; x < b.width; ++x) {
            relax(x, y, -1, 0, 5);
            relax(x, y, 0, -1, 5);
            relax(x, y, -1, -1, 7);
            relax(x, y, 1, -1, 7);
        }
    for (int y = b.height - 1; y >= 0; --y)
        for (int x = b.width - 1; x >= 0; --x) {
            relax(x, y, 1, 0, 5);
            relax(x, y, 0, 1, 5);
            relax(x, y, 1, 1, 7);
            relax(x, y, -1, 1, 7);
        }
    // The first pass leaves what it could not reach at "far" and its own index; the second reaches
    // it.
    return nearest;
}

}  // namespace

CovarianceBuffer smooth(const CovarianceBuffer& buffer) {
    CovarianceBuffer result(buffer.width, buffer.height);
    if (std::none_of(buffer.weight.begin(), buffer.weight.end(), [](float w) { return w > 0; }))
        return result;
    const std::vector<size_t> nearest = nearest_lit(buffer);
    parallel_for(buffer.height, [&](int64_t row) {
        const int y = int(row);
        for (int x = 0; x < buffer.width; ++x) {
            const size_t i = size_t(y) * size_t(buffer.width) + size_t(x);
            Covariance5 sum;
            float total = 0;
            for (int py = std::max(0, y - 1); py <= std::min(buffer.height - 1, y + 1); ++py)
                for (int px = std::max(0, x - 1); px <= std::min(buffer.width - 1, x + 1); ++px) {
                    const size_t j = size_t(py) * size_t(buffer.width) + size_t(px);
                    sum = sum + buffer.weight[j] * buffer.covariance[j];
                    total += buffer.weight[j];
                }
            result.weight[i] = buffer.weight[i];
            result.covariance[i] = total > 0 ? (1 / total) * sum : buffer.covariance[nearest[i]];
        }
    });
    return result;
}

}  // namespace covtrace
