/// Gives the image the light of its samples back where the filters lost it.
#pragma once

#include <vector>

#include "reconstruction/half_buffer.h"
#include "reconstruction/likeness.h"

namespace covtrace {

/// Filters, limits for outliers and networks take light from where it is rare, and judges of few
/// samples do not see it. What an image lacks of the samples is
///     e(p) = raw(p) - color(p),
/// whose mean over many pixels p is known better than that of any one. Around every pixel, over
/// those that are alike in features and light, color becomes
///     color + (1 - k s^2 / ((sum w e)^2 + s^2))_+ (sum w e / sum w Y) Y,   s^2 = sum w^2 V,
/// Y its luminance and V the variance of raw: as many times as bright, as the samples around say,
/// where they say more than their noise could (James and Stein's factor). First with w of a
/// deviation of 12 pixels, then 48, then 192 (k = 1), then once over the whole image, where nearly
/// everything counts (k = 0.1), so that it has the light of the samples. Light goes to what is
/// alike, so none leaves a dark wall for a bright window beside it. What alone would make all
/// around it a fifteenth brighter, as a small lamp that one half saw, stays in its pixels.
/// docs/decisions/0085.
class LightReturn {
  public:
    /// Keeps what it needs of the halves, with their holes filled, before outliers are limited.
    explicit LightReturn(const Halves& halves);

    /// `raw`: the mean of the samples. Nothing becomes negative that is not already.
    void give_back(const ColorPlanes& raw, ColorPlanes& color) const;

  private:
    /// How alike the blocks of a level are, `light`: of the image.
    Likeness likeness_of(int level, const Plane& light) const;
    /// The last step. `e`: what is lacking, with `in_place`, what stays in its pixels.
    void give_to_all(const ColorPlanes& e, const ColorPlanes& in_place, ColorPlanes& color) const;

    std::vector<Plane> features_;  ///< of the finest level, in units that tell pixels apart
    Plane variance_;               ///< of raw's luminance, of the finest level
};

}  // namespace covtrace
