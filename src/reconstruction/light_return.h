/// Return of light: gives the image the light of its samples back where the filters lost it.
#pragma once

#include <vector>

#include "reconstruction/half_buffer.h"
#include "reconstruction/likeness.h"

namespace covtrace {

/// Returns lost light. Filters, limits for outliers and networks take light from where it is rare,
/// and judges of few samples do not see it. The light that an image lacks of the samples is
///     e(p) = raw(p) - color(p),
/// whose mean over many pixels p is known better than that of any one. Around every pixel, over the
/// pixels that are alike in features and light, color becomes
///     color + (1 - k s^2 / L(sum w e)^2)_+ (sum w e / sum w Y) Y,   s^2 = sum w^2 V,
/// L luminance, Y = L(color) and V the variance of L(raw): as many times as bright as the samples
/// around say, from a tenth to ten times, where they say more than their noise could (James and
/// Stein's factor). This is done first with w of a deviation of 12 pixels, then 48, then 192 (k =
/// 1), then once over the whole image, where nearly everything counts (k = 0.1), so that the image
/// has the light of the samples. Light goes to pixels that are alike, so none leaves a dark wall
/// for a bright window beside it. Light of one place that alone would make all around it a
/// fifteenth brighter, as a small lamp that one half saw, stays in its pixels
/// (docs/decisions/0085).
class LightReturn {
  public:
    /// Keeps features and variances of the halves, with their holes filled, before outliers are
    /// limited.
    explicit LightReturn(const Halves& halves);

    /// Gives light back to `color`; `raw` is the mean of the samples. No pixel becomes negative
    /// that is not so already.
    void give_back(const ColorPlanes& raw, ColorPlanes& color) const;

  private:
    /// The likeness of the blocks of a level (0 the finest); `light` is the image's luminance.
    Likeness likeness_of(int level, const Plane& light) const;
    /// Gives light to the whole image, as the last step. `e` is the lacking light, which includes
    /// `in_place`, the light that stays in its pixels.
    void give_to_all(const ColorPlanes& e, const ColorPlanes& in_place, ColorPlanes& color) const;

    /// Features of the finest level, in units that tell pixels apart.
    std::vector<Plane> features_;
    Plane variance_;  ///< variance of raw's luminance, on the finest level
};

}  // namespace covtrace
