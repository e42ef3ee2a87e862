/// The sky as it is seen from places near one another: a density over directions by the light that
/// gets there, even within blocks of the same solid angle.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/hash.h"
#include "core/vec.h"
#include "core/warp.h"
#include "light/equal_area.h"

namespace covtrace {

class SkyCell {
  public:
    static constexpr size_t kSide = 32;  ///< blocks along a side of the equal-area square
    static constexpr size_t kBlocks = kSide * kSide;
    /// Share of the samples that are spread over all directions, whatever the weights.
    static constexpr double kEverywhere = 0.02;

    /// The block of a unit direction in world space.
    static size_t block(Vec3 w) {
        const Vec2 p = equal_area_sphere_to_square(w);
        const auto index = [](float s) {
            return std::min(static_cast<size_t>(std::max(s * float(kSide), 0.0f)), kSide - 1);
        };
        return index(p.y) * kSide + index(p.x);
    }

    /// Sets the blocks' weights, which are not negative; where all are 0 every block is as likely.
    void set_weights(const std::array<double, kBlocks>& weights) {
        double sum = 0;
        for (double w : weights) sum += w;
        const double scale = sum > 0 ? (1 - kEverywhere) / sum : 0;
        const double even = (sum > 0 ? kEverywhere : 1) / double(kBlocks);
        double below = 0;
        for (size_t y = 0; y < kSide; ++y) {
            double row = 0;
            for (size_t x = 0; x < kSide; ++x) row += weights[y * kSide + x] * scale + even;
            double left = 0;
            for (size_t x = 0; x < kSide; ++x) {
                left += weights[y * kSide + x] * scale + even;
                columns_[y].upper[x] = static_cast<float>(left / row);
            }
            columns_[y].upper.back() = 1;
            below += row;
            rows_.upper[y] = static_cast<float>(below);
        }
        rows_.upper.back() = 1;
    }
    /// Samples a unit direction.
    Vec3 sample(Vec2 u) const {
        const size_t y = rows_.choose(u.y), x = columns_[y].choose(u.x);
        return equal_area_square_to_sphere(
            {(float(x) + u.x) / float(kSide), (float(y) + u.y) / float(kSide)});
    }
    /// Density of `sample`, per solid angle.
    float pdf(Vec3 w) const {
        const size_t i = block(w), y = i / kSide;
        return rows_.probability(y) * columns_[y].probability(i % kSide) * float(kBlocks) *
               kUniformSpherePdf;
    }

    float share = 0;  ///< share of the samples of the sky that should follow the cell

  private:
    /// Cumulated probabilities, the last of which is 1.
    struct Cumulated {
        std::array<float, kSide> upper{};
        float lower(size_t i) const { return i > 0 ? upper[i - 1] : 0.0f; }
        float probability(size_t i) const { return upper[i] - lower(i); }
        /// Chooses an entry; u becomes its place within the entry, in [0, 1).
        size_t choose(float& u) const {
            size_t i = 0;
            for (float bound : upper) i += bound <= u ? 1 : 0;
            u = std::clamp((u - lower(i)) / probability(i), 0.0f, kLargestBelowOne);
            return i;
        }
    };
    Cumulated rows_;
    std::array<Cumulated, kSide> columns_;  ///< of each row
};

}  // namespace covtrace
