/// The current transformation matrix. Exporters write matrices that flatten space around nothing:
/// one that can't be inverted is an error only where something is placed by it.
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
    /// Nothing can be placed: `problem` says why, `where` the directive that is to blame.
    CurrentTransform(SourceLocation where, std::string problem)
        : problem_(Problem{std::move(where), std::move(problem)}) {}

    /// For what stands at `user`. Errors: Error(scene) where nothing can be placed.
    const Transform& get(const SourceLocation& user) const;
    /// This one after `inner`. A product whose numbers are too large for single precision places
    /// nothing, because of the directive at `where`.
    CurrentTransform times(const CurrentTransform& inner, const SourceLocation& where) const;
    /// Whether both place alike; of two that place nothing, true.
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

/// Of 16 numbers, columns first. A matrix that is singular or not affine places nothing.
CurrentTransform transform_of_matrix(const std::array<double, 16>& columns,
                                     const SourceLocation& where);
/// A factor of zero places nothing.
CurrentTransform transform_of_scale(double x, double y, double z, const SourceLocation& where);
/// Errors: Error(scene) for an axis without length, which says nothing.
Transform transform_of_rotation(double degrees, Vec3 axis, const SourceLocation& where);
/// Errors: Error(scene) for degenerate vectors, which say nothing.
Transform transform_of_look_at(Vec3 eye, Vec3 look, Vec3 up, const SourceLocation& where);

}  // namespace covtrace
