/// Owen-scrambled Sobol points: every number is a function of (seed, pixel, sample index,
/// dimension).
#pragma once

#include <array>
#include <cstdint>

#include "core/vec.h"

namespace covtrace {

/// The sample stream of one path. The first five dimensions (film x, y, lens u, v, time) come from
/// one scrambled five-dimensional Sobol sequence; all later ones are pairs of the two-dimensional
/// sequence, each pair with a shuffle and a scramble of its own ("padding").
///
/// Scrambling by hashing: Burley 2020, "Practical hash-based Owen scrambling" (JCGT 9(4)), with the
/// hash of Laine and Karras 2011. Every prefix of the sample indices is a usable point set.
///
/// Pixels of a tile of 16x16 share their scrambles and shift the sequence by index bits of their
/// own, so that the points of neighbours fill each other's gaps at any number of samples: a filter
/// over several pixels has less noise than the pixels' own noise would tell
/// (docs/decisions/0079-neighbours-fill-each-others-gaps.md).
class Sampler {
  public:
    Sampler(uint64_t seed, int pixel_x, int pixel_y, uint32_t sample_index);

    /// Position on the film, lens and shutter: the five dimensions at once, in [0, 1).
    struct CameraSample {
        Vec2 film, lens;
        float time = 0;
    };
    CameraSample camera();
    /// The position on the film alone, at less than half the price.
    Vec2 film() const;

    Vec2 pair(uint32_t number) const;  ///< the pair of that number, wherever the stream stands
    float next_1d();                   ///< the first number of a fresh pair
    Vec2 next_2d();                    ///< a fresh pair
    /// Four fresh pairs, the same as four calls of next_2d give, at less than the price of two.
    std::array<Vec2, 4> next_four_2d();
    /// Skips to a fixed dimension, so that later events see the same numbers whatever came before.
    void set_dimension(uint32_t pair) { pair_ = pair; }

  private:
    static constexpr uint64_t kFirstPair = 0x1000;  ///< below, keys of the camera's dimensions
    using PixelShifts = std::array<uint32_t, 256>;
    uint32_t index(uint64_t key, const PixelShifts& shifts) const;

    uint64_t key_;
    uint32_t reversed_index_;
    uint32_t pixel_;  ///< place in the tile: bits of its Morton code, reversed
    uint32_t pair_ = 0;
};

}  // namespace covtrace
