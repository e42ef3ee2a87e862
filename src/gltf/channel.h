/// Private to this folder: one animated property over time.
#pragma once

#include <array>
#include <vector>

#include "gltf/accessor.h"
#include "gltf/document.h"

namespace covtrace::gltf {

/// Kinds of a property's values, by the numbers that each is made of.
enum class ValueKind {
    vector3,   ///< three numbers: a translation or a scale
    rotation,  ///< a quaternion (x, y, z, w), which turns evenly from key to key
    list,      ///< as many numbers as the output has for each time: weights of morph targets
    any,       ///< a vector as the output's type has it, or a list of scalars
    positive,  ///< the same of a property that is not below 0, where splines overshoot
};

/// The keys of one property, by an animation's sampler.
class Channel {
  public:
    /// Reads animations[animation].samplers[sampler], which the channel at `place` names. Throws
    /// Error(scene) where times do not increase, or the output has not a value for each.
    Channel(const Document& document, size_t animation, int sampler, ValueKind kind,
            const std::string& place);

    /// The value at a time in seconds; before the first and after the last key that of the key.
    std::vector<double> at(double time) const;
    /// Seconds of the first and of the last key.
    std::array<float, 2> span() const { return {times_.values.front(), times_.values.back()}; }

  private:
    enum class Interpolation { step, linear, cubic_spline };
    ValueKind kind_;
    Interpolation interpolation_ = Interpolation::linear;
    Numbers times_, values_;
};

}  // namespace covtrace::gltf
