/// A disc of even radiance infinitely far away, such as the sun.
///
/// Directions are measured by their chord, the distance between them on the unit sphere: the areas
/// of caps are proportional to its square, and it stays exact where one minus the cosine of a small
/// angle does not.
#pragma once

#include "core/frame.h"
#include "core/vec.h"
#include "light/environment_map.h"
#include "scene/scene_description.h"

namespace covtrace {

class DistantDisc {
  public:
    /// Full angle, in degrees, below which single precision does not know the rim of a disc to a
    /// thousandth of its width: such a light shines from one direction.
    static constexpr float kLeastAngle = 0.01f;
    static bool has_extent(const DistantLight& light) { return light.angle >= kLeastAngle; }

    /// The disc of a light that has an extent around `centre`, a unit vector towards it.
    DistantDisc(const DistantLight& light, Vec3 centre);

    bool contains(Vec3 w) const { return length_squared(w - frame_.z) <= chord_squared_; }
    /// Radiance from the unit direction w, and the density of `sample` per solid angle.
    EnvironmentMap::Sight look(Vec3 w) const {
        return contains(w) ? EnvironmentMap::Sight{radiance_, pdf_} : EnvironmentMap::Sight{};
    }
    /// Samples a unit direction evenly among those of the disc.
    Vec3 sample(Vec2 u) const;

    Vec3 centre() const { return frame_.z; }
    Rgb irradiance() const { return irradiance_; }    ///< of a surface that faces the centre
    float angular_radius() const { return radius_; }  ///< radians
    /// Weight of the irradiance, for choosing among lights, of a surface with the unit normal n;
    /// that of the side which faces the disc for the zero vector.
    float choice_weight_at(Vec3 n) const;

  private:
    Frame frame_;
    float radius_, sine_;  // of the angular radius
    float chord_squared_, pdf_;
    Rgb irradiance_, radiance_;
};

}  // namespace covtrace
