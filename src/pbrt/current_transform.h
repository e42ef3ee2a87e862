/// The current transformation matrix. Exporters write matrices that flatten space around nothing,
/// so a matrix that can't be inverted is an error only where something is placed by it.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/error.h"
#include "core/transform.h"

namespace covtrace {

class CurrentTransform {
  public:
    CurrentTransform() = default;
    CurrentTransform(const Transform& transform) : transform_(transform) {}
    /// Makes a transform by which nothing can be placed: `problem` says why, `where` is the
    /// directive that is to blame.
    CurrentTransform(SourceLocation where, std::string problem)
        : problem_(Problem{std::move(where), std::move(problem)}) {}

    /// The transform, for an entity that stands at `user`. Errors: Error(scene) where nothing can
    /// be placed.
    const Transform& get(const SourceLocation& user) const;
    /// The product of this transform and `inner`, which acts first. A product whose numbers are too
    /// large for single precision places nothing, because of the directive at `where`.
    CurrentTransform times(const CurrentTransform& inner, const SourceLocation& where) const;
    /// Whether both place alike; true for two that place nothing.
    bool operator==(const CurrentTransform& other) const {
        return problem_.has_value() == other.problem_.has_value() && transform_ == other.transform_;
    }

  private:
    struct Problem {
        SourceLocation where;
        std::string text;
    };
    Transform transform_;
    std::optional<Problem> problem_;
};

/// Makes a transform of 16 numbers, columns first. A matrix that is singular or not affine places
/// nothing.
CurrentTransform transform_of_matrix(const std::array<double, 16>& columns,
                                     const SourceLocation& where);
/// Makes a scale. A factor of zero places nothing.
CurrentTransform transform_of_scale(double x, double y, double z, const SourceLocation& where);
/// Makes a rotation. Errors: Error(scene) for an axis without length, which says nothing.
Transform transform_of_rotation(double degrees, Vec3 axis, const SourceLocation& where);
/// Makes pbrt's LookAt. Errors: Error(scene) for degenerate vectors, which say nothing.
Transform transform_of_look_at(Vec3 eye, Vec3 look, Vec3 up, const SourceLocation& where);

}  // namespace covtrace
