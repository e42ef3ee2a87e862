/// Motion of a shape: up to two animated transforms, one on top of the other, within a shutter.
#pragma once

#include <vector>

#include "core/transform.h"
#include "geometry/affine.h"

namespace covtrace {

/// The shutter, and a parameter in [0, 1] over it in which the times where any motion of the scene
/// starts or stops are equally spaced. Embree's keys are uniform in that parameter, so that every
/// start and stop falls on a key. (Embree 3.13 can also give each geometry a time range of its own,
/// but then loses hits where ranges differ.)
class ShutterClock {
  public:
    /// Makes a clock; `close` may equal `open`. Throws Error(limit) for more than 128 different key
    /// times within the shutter.
    ShutterClock(float open, float close, const std::vector<float>& key_times);

    float open() const { return breaks_.front(); }
    float close() const { return breaks_.back(); }
    /// Number of the stretches of time between starts and stops, at least 1.
    unsigned segments() const { return static_cast<unsigned>(breaks_.size()) - 1; }
    /// The parameter of a scene time, which is clamped to the shutter.
    float parameter(float time) const;
    /// The scene time of key `i` of `count`, which is a multiple of segments().
    float key_time(unsigned i, unsigned count) const;

  private:
    std::vector<float> breaks_;
};

inline float ShutterClock::parameter(float time) const {
    if (!(time > open())) return 0;
    if (time >= close()) return 1;
    size_t i = 0;
    while (time >= breaks_[i + 1]) ++i;
    const float f = (time - breaks_[i]) / (breaks_[i + 1] - breaks_[i]);
    return (static_cast<float>(i) + f) / static_cast<float>(segments());
}

/// Largest distance between where Embree and a motion place a point, but for roundings, as a part
/// of the extent of the shape. Straight lines between Embree's keys are such: chords of an angle a
/// miss the circle by a^2 / 8 of its radius, and the most keys do it for a turn of 60 degrees.
inline constexpr double kPlacementError = 1e-5;

/// The map `outer` after `inner`, over time; null stands for the identity. Does not own the
/// transforms.
struct Motion {
    const AnimatedTransform* outer = nullptr;
    const AnimatedTransform* inner = nullptr;

    Transform at(float time) const;
    /// Whether anything moves between `begin` and `end`.
    bool moves(float begin, float end) const;
    /// Derivative of the map by scene time at `time`; one-sided at the ends of a movement. Zero
    /// where the motion rests at `time`.
    Affine rate(float time, const ShutterClock& clock) const;
};

}  // namespace covtrace
