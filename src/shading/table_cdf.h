/// A tabulated distribution function, inverted without a search: for every slice of u it is known
/// where to begin (Chen and Asau 1974, "On generating random variates from an empirical
/// distribution"). The same numbers as by bisection; u stays stratified.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/hash.h"

namespace covtrace {

class TableCdf {
  public:
    TableCdf() = default;
    /// `cumulated`: running sums of weights that are not negative; where all are zero every entry
    /// is as likely.
    explicit TableCdf(const std::vector<double>& cumulated);

    /// Index of the entry that holds u in [0, 1); u becomes its place within the entry, in [0, 1).
    size_t sample(float& u) const {
        const size_t slices = first_.size();
        size_t i = first_[static_cast<size_t>(u * static_cast<float>(slices))];
        while (i + 1 < upper_.size() && upper_[i] <= u) ++i;
        const float lo = i > 0 ? upper_[i - 1] : 0.0f, width = upper_[i] - lo;
        u = width > 0 ? std::clamp((u - lo) / width, 0.0f, kLargestBelowOne) : u;
        return i;
    }

  private:
    static constexpr size_t kEntriesPerSlice = 2;

    std::vector<float> upper_;     ///< cumulated shares, the last is 1
    std::vector<uint32_t> first_;  ///< the entry where each slice of u begins
};

inline TableCdf::TableCdf(const std::vector<double>& cumulated) : upper_(cumulated.size()) {
    const double sum = cumulated.empty() ? 0 : cumulated.back();
    const auto count = static_cast<double>(cumulated.size());
    for (size_t i = 0; i < upper_.size(); ++i)
        upper_[i] =
            static_cast<float>(sum > 0 ? cumulated[i] / sum : static_cast<double>(i + 1) / count);
    first_.resize((upper_.size() + kEntriesPerSlice - 1) / kEntriesPerSlice);
    const auto slices = static_cast<float>(first_.size());
    for (size_t i = 0, slice = 0; slice < first_.size(); ++slice) {
        // Rounding of u * slices may reach a slice a little early.
        const float begin = static_cast<float>(slice) / slices * (1 - 0x1p-22f);
        while (i + 1 < upper_.size() && upper_[i] <= begin) ++i;
        first_[slice] = static_cast<uint32_t>(i);
    }
}

}  // namespace covtrace
