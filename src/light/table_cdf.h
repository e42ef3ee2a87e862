/// A tabulated distribution function, inverted without a search: a table tells for every slice of u
/// where to begin (Chen and Asau 1974, "On generating random variates from an empirical
/// distribution"). It gives the same numbers as bisection; u stays stratified.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/hash.h"
#include "core/huge_pages.h"

namespace covtrace {

class TableCdf {
  public:
    TableCdf() = default;
    /// Makes one distribution. `cumulated`: running sums of weights that are not negative; where
    /// all are zero every entry is as likely.
    explicit TableCdf(const std::vector<double>& cumulated) : TableCdf(1, cumulated.size()) {
        set_row(0, cumulated);
    }
    /// Makes room for several distributions of the same size side by side, to be set one by one.
    TableCdf(size_t rows, size_t entries);
    /// Sets one distribution. Different rows may be set at the same time.
    void set_row(size_t row, const std::vector<double>& cumulated);

    /// Index of the entry that holds u in [0, 1); u becomes its place within the entry, in [0, 1).
    size_t sample(float& u, size_t row = 0) const { return finish(begin(u, row), u, row); }

    /// The first half of `sample`, for callers that have something else to do while memory answers:
    /// where to begin to look for u. It only reads the small table and asks memory for the large
    /// one.
    size_t begin(float u, size_t row = 0) const {
        const size_t first =
            first_[row * slices_ + static_cast<size_t>(u * static_cast<float>(slices_))];
        __builtin_prefetch(&upper_[row * stride_ + first]);
        return first;
    }
    /// The second half of `sample`, from the place that `begin` gave.
    size_t finish(size_t first, float& u, size_t row = 0) const {
        const float* upper = &upper_[row * stride_];
        size_t i = first;
        for (size_t below = kLanes; below == kLanes; i += below) {
            below = 0;
            for (size_t k = 0; k < kLanes; ++k) below += upper[i + k] <= u ? 1 : 0;
        }
        const float lo = i > 0 ? upper[i - 1] : 0.0f, width = upper[i] - lo;
        u = width > 0 ? std::clamp((u - lo) / width, 0.0f, kLargestBelowOne) : u;
        return i;
    }

  private:
    /// Entries of a slice: so few slices that those of all rows of an image stay in the cache,
    /// though their entries do not.
    static constexpr size_t kEntriesPerSlice = 16;
    static constexpr size_t kLanes = 8;  ///< entries that are compared at once

    size_t entries_ = 0, stride_ = 0, slices_ = 0;  ///< of each row
    /// Cumulated shares of each row, of which the last is 1; then as many larger ones as lanes.
    HugePageVector<float> upper_;
    HugePageVector<uint32_t> first_;  ///< the entry where each slice of u begins
};

inline TableCdf::TableCdf(size_t rows, size_t entries)
    : entries_(entries),
      stride_(entries + kLanes),
      slices_((entries + kEntriesPerSlice - 1) / kEntriesPerSlice),
      upper_(rows * stride_, 2.0f),
      first_(rows * slices_) {}

inline void TableCdf::set_row(size_t row, const std::vector<double>& cumulated) {
    const double sum = cumulated.empty() ? 0 : cumulated.back();
    const auto count = static_cast<double>(entries_);
    float* upper = upper_.data() + row * stride_;
    for (size_t i = 0; i < entries_; ++i)
        upper[i] =
            static_cast<float>(sum > 0 ? cumulated[i] / sum : static_cast<double>(i + 1) / count);
    const auto slices = static_cast<float>(slices_);
    for (size_t i = 0, slice = 0; slice < slices_; ++slice) {
        // Rounding of u * slices may reach a slice a little early.
        const float begin = static_cast<float>(slice) / slices * (1 - 0x1p-22f);
        while (i + 1 < entries_ && upper[i] <= begin) ++i;
        first_[row * slices_ + slice] = static_cast<uint32_t>(i);
    }
}

}  // namespace covtrace
