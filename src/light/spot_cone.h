/// The cone that the light of a spotlight stays within.
#pragma once

#include <functional>
#include <optional>

#include "core/transform.h"
#include "core/vec.h"

namespace covtrace {

/// Light falls off from its whole intensity in the inner cone to nothing outside of the outer one.
class SpotCone {
  public:
    /// From degrees, as SpotLight has them, about the unit vector `axis` of a space that
    /// `to_world` places. Where that stretches the space, the cone is stretched with it, as in
    /// pbrt-v4: the angle counts that a direction has to the axis before.
    static SpotCone from_degrees(float angle, float delta_angle, const Transform& to_world = {},
                                 Vec3 axis = {0, 0, 1});
    /// A deep grid before the light, as softboxes have one: at the angle t to the axis (unit, world
    /// space) its slats leave the share 1 - tan(t) / tan(angle), the angle in degrees; at 90 they
    /// leave everything.
    static SpotCone grid(float angle, Vec3 axis = {0, 0, 1});

    /// The factor in [0, 1] on the light in the unit direction w away from it, world space: as in
    /// pbrt-v4 a smoothstep of the cosine between both cones, or a grid's.
    float falloff(Vec3 w) const;
    /// The integral of the factor over all directions, steradians.
    float solid_angle() const;
    /// The same times the cosine to the unit normal n, over the directions above it: what a flat
    /// light with this normal sends through the cone, where it sends pi without.
    float projected_solid_angle(Vec3 n) const;
    /// Angular variance of the light along one axis across the cone's own, radians^2; the mean of
    /// both where the cone is stretched.
    float variance() const;

    Vec3 axis() const { return axis_; }  ///< unit, world space
    /// Half angles about the axis in world space that the inner cone and the light stay within,
    /// radians.
    float inner_angle() const { return inner_angle_; }
    float outer_angle() const { return outer_angle_; }

  private:
    /// One minus the cosine to the axis that counts for the world direction w: its roundings are a
    /// share of it, however small the angle.
    float one_minus_cosine(Vec3 w) const;
    double share(double one_minus_cosine) const;
    /// Calls use(direction, solid angle, factor) for steps that cover the outer cone.
    void for_steps(int rings, int sectors,
                   const std::function<void(Vec3, double, double)>& use) const;
    /// The largest angle in world space to the axis, of directions with the given angle before.
    float stretched(float angle) const;

    Vec3 axis_{0, 0, 1};
    float inner_ = 2, outer_ = 2;  ///< one minus the cosines of the half angles
    float inner_angle_ = kPi, outer_angle_ = kPi;
    bool is_grid_ = false;
    float grid_tangent_ = 0;  ///< of the outer angle
    /// Where the cone is stretched: from world space to that in which it is not, and its axis
    /// there.
    std::optional<Transform> unstretch_;
    Vec3 axis_before_{0, 0, 1};
};

}  // namespace covtrace
