/// Likeness of pixels to those around them: sums over pixels that should be reconstructed in one
/// way.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/plane.h"
#include "core/simd.h"

namespace covtrace {

/// A plane with a margin of zeros, so that windows around its pixels never leave it.
class MarginPlane {
  public:
    static constexpr int kMargin = 12;
    MarginPlane(int width, int height)
        : stride_(size_t(width) + 2 * kMargin + kLanes),
          values_(stride_ * (size_t(height) + 2 * kMargin)) {}
    explicit MarginPlane(const Plane& plane);

    /// Pointer to a pixel's value; pixels up to kMargin outside the image may be read.
    const float* at(int x, int y) const { return values_.data() + index(x, y); }
    float& operator()(int x, int y) { return values_[index(x, y)]; }

  private:
    size_t index(int x, int y) const { return size_t(y + kMargin) * stride_ + size_t(x + kMargin); }
    size_t stride_;
    std::vector<float> values_;
};

/// Settings of Likeness, both from the sweep in
/// docs/decisions/0094-candidates-and-their-mixture.md.
struct LikenessSettings {
    float sigma = 6;    ///< deviation of the Gaussian G, pixels
    float any = 0.05f;  ///< share that everything around has, alike or not
};

/// Weights of the pixels q around p, up to kReach pixels away in x and in y:
///     w(p, q) = G(q - p) (any + (1 - any) exp(-1/2 sum_k (guide_k(p) - guide_k(q))^2))
class Likeness {
  public:
    static constexpr int kReach = 11;  ///< as far as three vectors of a row go
    static constexpr size_t kRows = 2 * kReach + 1, kColumns = 3 * kLanes;
    /// Weights of a window, row by row from the upper left; those right of the window are not used.
    using Window = std::array<float, kRows * kColumns>;

    explicit Likeness(const LikenessSettings& settings);

    /// Adds a guide, in units in which pixels that differ by 1 are not alike.
    void add(const Plane& guide) { guides_.emplace_back(guide); }

    void weigh(int x, int y, Window& weights) const;

    /// The sum of the weights of a window whose pixels are all alike, in an image of w x h pixels:
    /// what is beyond its edges has no weight.
    float most(int x, int y, int w, int h) const;

    /// Whether two pixels of the image hardly differ: sums around them are as good as the same.
    bool are_alike(int px, int py, int qx, int qy) const;

  private:
    std::vector<MarginPlane> guides_;
    Window gaussian_{};
    float any_, most_ = 0;
};

/// Sets sums[k] to the sum of plane k's values times the weights around a pixel; beyond the image
/// all values are 0.
void weighted_sums(std::span<const MarginPlane> planes, const Likeness::Window& weights, int x,
                   int y, float* sums);

}  // namespace covtrace
