/// Return of light: gives the image the light of its samples back where the filters lost it.
#pragma once

#include <cstdint>
#include <vector>

#include "reconstruction/half_buffer.h"
#include "reconstruction/likeness.h"

namespace covtrace {

/// How the samples of both halves were drawn.
enum class HalvesNoise : uint8_t {
    of_one_sequence,  ///< parts of one even sequence: where one half has samples the other has gaps
    independent,      ///< with seeds of their own
};

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
/// (docs/decisions/0085), of halves with noise of their own as far as both saw it: of
/// e_A = A - color and e_B = B - color the share (e_A e_B / e^2)_+, luminances all, whose numerator
/// is without the noise of e^2 (docs/decisions/0106).
class LightReturn {
  public:
    /// Keeps features and variances of the halves, with their holes filled, before outliers are
    /// limited.
    explicit LightReturn(const Halves& halves, HalvesNoise noise = HalvesNoise::of_one_sequence);

    /// Gives light back to `color`; `raw` is the mean of the samples. No pixel becomes negative
    /// that is not so already.
    void give_back(const ColorPlanes& raw, ColorPlanes& color) const;

  private:
    /// The likeness of the blocks of a level (0 the finest); `light` is the image's luminance.
    Likeness likeness_of(int level, const Plane& light) const;
    /// Gives light to the whole image, as the last step. `e` is the lacking light, which includes
    /// `in_place`, the light that stays in its pixels.
    void give_to_all(const ColorPlanes& e, const ColorPlanes& in_place, ColorPlanes& color) const;
    /// Drops light that stays in its pixels, `in_place` of the lacking light `e`, as far as both
    /// halves did not see it.
    void keep_what_both_saw(const ColorPlanes& e, ColorPlanes& in_place) const;

    /// Features of the finest level, in units that tell pixels apart.
    std::vector<Plane> features_;
    /// The variance of raw's luminance in the blocks of a level.
    Plane variance_of(int level) const;

    Plane variance_;  ///< variance of raw's luminance, on the finest level
    /// Half the difference of the halves' luminances where their noise is independent; else empty.
    Plane half_difference_;
};

}  // namespace covtrace
