#include "planner/covariance_buffer.h"

#include <algorithm>

#include "core/parallel.h"

namespace covtrace {

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
            const auto windowed = covariance::preintegrate(s);
            p.spectrum[i] = {float(windowed.xx), float(windowed.xy), float(windowed.yy)};
            p.interior_count[i] = float(covariance::integration_count(s));
        }
    });
    return p;
}

namespace {

/// Mean over the weighted pixels of the smallest square ring around (x, y) that has any.
bool borrow(const CovarianceBuffer& b, int x, int y, Covariance5& mean, float& weight) {
    const int farthest = std::max(b.width, b.height);
    for (int r = 1; r <= farthest; ++r) {
        Covariance5 sum;
        float total = 0;
        for (int dy = -r; dy <= r; ++dy) {
            const int step = std::abs(dy) == r ? 1 : 2 * r;
            for (int dx = -r; dx <= r; dx += step) {
                const int px = x + dx, py = y + dy;
                if (px < 0 || py < 0 || px >= b.width || py >= b.height) continue;
                const size_t j = size_t(py) * size_t(b.width) + size_t(px);
                if (!(b.weight[j] > 0)) continue;
                sum = sum + b.weight[j] * b.covariance[j];
                total += b.weight[j];
            }
        }
        if (total > 0) {
            mean = (1 / total) * sum;
            weight = 0;
            return true;
        }
    }
    return false;
}

}  // namespace

CovarianceBuffer smooth(const CovarianceBuffer& buffer) {
    CovarianceBuffer result(buffer.width, buffer.height);
    if (std::none_of(buffer.weight.begin(), buffer.weight.end(), [](float w) { return w > 0; })) return result;
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
            if (total > 0)
                result.covariance[i] = (1 / total) * sum;
            else
                borrow(buffer, x, y, result.covariance[i], result.weight[i]);
        }
    });
    return result;
}

}  // namespace covtrace
