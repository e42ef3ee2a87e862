/// Return of light: gives the image the light of its samples back where the filters lost it.
#pragma once

#include <cstdint>
#include <span>
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
///     (1 + c L(sum w e) / L(sum w color)) color,
/// L luminance: as many times as bright as the samples around say, from a tenth to ten times, as
/// far as they know, in the colour that they have: a few bright paths have colours of their own.
/// This is done with w of deviations of 192, 48 and 12 pixels, narrower windows giving what wider
/// ones left, then once over the whole image. The factor is Wiener's,
///     c = t^2 / (t^2 + k s^2),
/// s^2 the variance of L(sum w e) and t^2 the mean of L(sum w e)^2 - k s^2 over the next wider
/// windows around, both relative to the light; s^2 is at least its own mean there. A window alone
/// does not know its noise: where no rare path fell its samples look certain, where a few fell it
/// looks lit (docs/decisions/0129). The whole image has no other around it, and gets James and
/// Stein's factor (1 - k s^2 / L(e)^2)_+ for each channel. k is 1, of the whole image 0.1, 3
/// with 4 samples per pixel, in between and beyond in proportion to 1 / n of n samples
/// (docs/decisions/0117).
///
/// In the narrowest windows and in the whole image s^2 = sum w^2 V, V the variance of L(raw). Wider
/// windows have it from how far narrower ones scatter around their mean, less by as much as those
/// scattered less than they should have, since an image keeps noise of its samples and does not
/// lack it; but at least from how few places e is (docs/decisions/0111). For halves with noise of
/// their own what they differ by tells s^2 of the windows (docs/decisions/0106).
///
/// Light goes to pixels that are alike, so none leaves a dark wall for a bright window beside it.
/// Light of one place that alone would make all around it a fifteenth brighter, as a small lamp
/// that one half saw, stays in its pixels (docs/decisions/0085), of halves with noise of their own
/// as far as both saw it: of e_A = A - color and e_B = B - color the share (e_A e_B / e^2)_+,
/// luminances all, whose numerator is without the noise of e^2.
class LightReturn {
  public:
    /// Keeps features and variances of the halves, with their holes filled, before outliers are
    /// limited. `few` tells how few samples they have: 0 where they are enough, 1 with a quarter of
    /// that, and so on in proportion to the variance of a pixel.
    explicit LightReturn(const Halves& halves, HalvesNoise noise = HalvesNoise::of_one_sequence,
                         float few = 0);

    /// Gives light back to `color`; `raw` is the mean of the samples. No pixel becomes negative
    /// that is not so already.
    void give_back(const ColorPlanes& raw, ColorPlanes& color) const;

  private:
    /// The light that each block lacks, as multiples of its own. `e` is the lacking light of the
    /// blocks.
    Plane lacking(const ColorPlanes& e, const ColorPlanes& color) const;
    struct Level;
    /// The sums over windows, from the narrowest on, and their noise.
    std::vector<Level> levels(const ColorPlanes& e, const ColorPlanes& color,
                              std::span<const Plane> guides) const;
    /// How much of what the windows of one level lack is real, as Wiener's filter has it, from the
    /// noise and the squares of what they lack and of their light. A window alone cannot tell:
    /// where no rare path fell, its samples look certain.
    Plane share_that_is_real(std::span<const Plane> guides, int level, const Plane& noise,
                             const Plane& squared, const Plane& light) const;
    /// The variance of the mean lacking light of the blocks.
    Plane block_variance() const;
    /// Gives the lacking light `e` to the whole image, as the last step.
    void give_to_all(const ColorPlanes& e, ColorPlanes& color) const;
    /// Drops light that stays in its pixels, `in_place` of the lacking light `e`, as far as both
    /// halves did not see it.
    void keep_what_both_saw(const ColorPlanes& e, ColorPlanes& in_place) const;

    HalvesNoise noise_;
    float windows_noise_, all_noise_;  ///< factors k of the windows and of the whole image
    std::vector<Plane> features_;      ///< features of the blocks, in units that tell pixels apart
    Plane variance_;                   ///< variance of raw's luminance in the blocks
    /// Half the difference of the halves' luminances, where their noise is independent, else empty:
    /// of the pixels and of the blocks.
    Plane half_difference_, block_half_difference_;
};

}  // namespace covtrace
