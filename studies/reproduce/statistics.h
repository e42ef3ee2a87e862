/// Statistics of lists of values: mean, quantile, median.
#pragma once

#include <algorithm>
#include <vector>

namespace covtrace::reproduce {

inline double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v;
    return values.empty() ? 0 : sum / double(values.size());
}

/// The value below which a share of the values lies; 0 where there is none.
inline double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    const auto at = std::min(values.size() - 1, size_t(share * double(values.size())));
    std::nth_element(values.begin(), values.begin() + long(at), values.end());
    return values[at];
}

inline double median(std::vector<double> values) {
    return quantile(std::move(values), 0.5);
}

}  // namespace covtrace::reproduce
