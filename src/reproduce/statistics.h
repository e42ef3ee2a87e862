/// What many values have in common.
#pragma once

#include <algorithm>
#include <vector>

namespace covtrace::reproduce {

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
