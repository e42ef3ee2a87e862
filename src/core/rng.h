/// A sequence of independent random numbers (SplitMix64), for uses that need no stratification.
#pragma once

#include "core/hash.h"
#include "core/vec.h"

namespace covtrace {

class Rng {
  public:
    explicit constexpr Rng(uint64_t seed) : state_(mix_bits(seed)) {}
    constexpr uint32_t next_uint() {
        state_ += 0x9e3779b97f4a7c15ull;
        return static_cast<uint32_t>(mix_bits(state_) >> 32);
    }
    constexpr float next_float() { return to_unit_float(next_uint()); }
    constexpr Vec2 next_2d() {
        const float x = next_float();
        return {x, next_float()};
    }

  private:
    uint64_t state_;
};

}  // namespace covtrace
