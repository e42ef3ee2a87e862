/// Small bright parts of surfaces, which paths are led to: where a lamp stands close to a ceiling,
/// the inside of a shade, the gap of a curtain.
///
/// Such a spot may send out half of the light of a room, from a thousandth of what a place sees:
/// paths meet it once in a thousand times, and the image is full of lonely bright pixels. The bins
/// of a histogram of directions are larger than that, and a spot that is near lies in other
/// directions from one end of a cell than from the other. Spots are balls in space instead, found
/// among the ends of the bounces that bring the most noise.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

namespace covtrace {

/// A bounce that ended at a lit surface.
struct SpotHit {
    Vec3 from, to;    ///< places, world
    float light = 0;  ///< luminance of the light that it found
    /// Square of what it brings the image, over the brightness there, where the BSDF leads alone.
    float moment = 0;
    float path_pdf = 0;  ///< density that it was drawn with, per solid angle
    float bsdf_pdf = 0;  ///< that of the BSDF
    uint32_t path = 0;   ///< number of the path
};

class BrightSpots {
  public:
    static constexpr size_t kMost = 8;

    /// The spots as a place sees them: cones of directions, each chosen with a probability.
    class View {
      public:
        bool is_empty() const { return count_ == 0; }
        Vec3 sample(Vec2 u) const;
        /// Density of `sample`, per solid angle.
        float pdf(Vec3 w) const;

      private:
        friend class BrightSpots;
        struct Cone {
            Vec3 axis;
            float height = 0;       ///< 1 less the cosine of its half angle
            float probability = 0;  ///< of all cones 1
        };
        std::array<Cone, kMost> cones_;
        size_t count_ = 0;
    };

    /// Makes no spots.
    BrightSpots() = default;
    /// Finds the spots that, sampled, would take the most noise away; none where these are few or
    /// take little. `noise`: the sum of the moments of all bounces, `bounces`: their number.
    BrightSpots(std::span<const SpotHit> hits, double noise, size_t bounces);

    bool is_empty() const { return spots_.empty(); }
    /// Those above the horizon of a place with the unit normal n, and the place in none of them.
    View seen_from(Vec3 p, Vec3 n) const;
    /// Whether a place is in a spot.
    bool holds(Vec3 p) const;

  private:
    struct Spot {
        Vec3 centre;
        float radius = 0;
        float intensity = 0;  ///< luminance over the mean of places
    };
    std::vector<Spot> spots_;
};

}  // namespace covtrace
