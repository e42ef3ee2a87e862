#include "prediction/covariance_buffer.h"

#include "core/parallel.h"

namespace covtrace {

CovarianceBuffer unpack(std::span<const PackedCovariance> packed, int width, int height) {
    CovarianceBuffer result(width, height);
    parallel_for_rows(width, height, [&](int row) {
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
    parallel_for_rows(buffers.width, buffers.height, [&](int row) {
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

Prediction preintegrated(const CovarianceBuffer& buffer) {
    Prediction p{buffer.width, buffer.height, std::vector<Covariance2>(buffer.covariance.size()),
                 std::vector<float>(buffer.covariance.size())};
    parallel_for_rows(buffer.width, buffer.height,
                      [&](int row) { covariance::preintegrate_row(buffer, row, p); });
    return p;
}

CovarianceBuffer smoothed(const CovarianceBuffer& buffer) {
    CovarianceBuffer result(buffer.width, buffer.height);
    const auto nearest =
        covariance::nearest_with_weight<float>(buffer.weight, buffer.width, buffer.height);
    parallel_for_rows(buffer.width, buffer.height, [&](int row) {
        covariance::smooth_row<float>(buffer, nearest, row, result);
    });
    return result;
}

}  // namespace covtrace
