/// The part of an emissive shape that the frequency analysis asks for: its size, border, curvature
/// and motion.
#pragma once

#include <array>
#include <optional>

#include "light/border.h"
#include "light/emitter.h"
#include "light/mesh.h"
#include "light/quadric.h"
#include "light/source_spectrum.h"

namespace covtrace {

class EmitterSpectrum {
  public:
    /// Measures the emitter of a shape; shape and emitter must outlive the spectrum.
    EmitterSpectrum(const PlacedShape& shape, const Emitter& emitter);

    /// The source spectrum at a point of the shape, whose unit normal `normal` is on the emitting
    /// outside; with the nearest border where it is asked for.
    SourceSpectrum at(Vec3 position, Vec3 normal, float time, bool with_border) const;

  private:
    std::optional<Vec3> nearest_border(Vec3 position, const Transform& now) const;

    const PlacedShape* shape_;
    const Emitter* emitter_;
    std::array<double, 6> moments_{};  // object space, about the centroid: xx, xy, xz, yy, yz, zz
    BorderEdges border_;               // world space at the start of the shutter
};

}  // namespace covtrace
