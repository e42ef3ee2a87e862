/// Affine and projective transforms, and rigid-plus-scale motion between two of them.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "core/vec.h"

namespace covtrace {

/// A 4x4 matrix in double: m[row][column], acts on column vectors.
struct Matrix4 {
    std::array<std::array<double, 4>, 4> m{
        {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    bool operator==(const Matrix4&) const = default;
};
Matrix4 operator*(const Matrix4& a, const Matrix4& b);
Matrix4 transpose(const Matrix4& a);
/// The inverse of a matrix; empty where it is singular or not finite.
std::optional<Matrix4> inverse(const Matrix4& a);

/// A matrix and its inverse, both at hand in double and applied in float.
class Transform {
  public:
    Transform() = default;
    Transform(const Matrix4& matrix, const Matrix4& inverse_matrix)
        : matrix_(matrix), inverse_(inverse_matrix) {}
    /// Makes a transform of a matrix; empty where that can't be inverted.
    static std::optional<Transform> from_matrix(const Matrix4& matrix);
    static Transform translate(Vec3 d);
    /// Scales the axes by factors, all of which must be non-zero.
    static Transform scale(double x, double y, double z);
    static Transform rotate(double degrees, Vec3 axis);
    /// World to camera, x right, y up, z forward, as in pbrt's LookAt; empty where the vectors are
    /// degenerate.
    static std::optional<Transform> look_at(Vec3 eye, Vec3 look, Vec3 up);

    const Matrix4& matrix() const { return matrix_; }
    const Matrix4& inverse_matrix() const { return inverse_; }
    Transform inverse() const { return {inverse_, matrix_}; }
    Vec3 point(Vec3 p) const;  ///< with the division by w where the last row asks for it
    Vec3 vector(Vec3 v) const;
    Vec3 normal(Vec3 n) const;  ///< by the inverse transpose; not normalised
    bool swaps_handedness() const;
    bool is_identity() const { return matrix_ == Matrix4{}; }
    bool operator==(const Transform&) const = default;

  private:
    Matrix4 matrix_, inverse_;
};
Transform operator*(const Transform& a, const Transform& b);

/// A rotation as the unit quaternion w + xi + yj + zk.
struct Quaternion {
    double x = 0, y = 0, z = 0, w = 1;
};
Quaternion slerp(double t, Quaternion a, Quaternion b);

/// A transform that moves between two keys over [start_time, end_time] and rests outside.
/// Each key is decomposed into translation, rotation and a symmetric stretch (polar_decomposition),
/// which are interpolated linearly, spherically (the short way) and linearly, as in pbrt; a half
/// turn is a half circle.
class AnimatedTransform {
  public:
    AnimatedTransform() = default;
    explicit AnimatedTransform(const Transform& still) : start_(still) {}
    AnimatedTransform(const Transform& start, float start_time, const Transform& end,
                      float end_time);

    bool is_animated() const { return movement_ != nullptr; }
    float start_time() const { return start_time_; }
    float end_time() const { return end_time_; }
    const Transform& start() const { return start_; }
    const Transform& end() const;
    Transform at(float time) const;
    /// The matrix of at(time), without the price of the inverse.
    Matrix4 matrix_at(float time) const;
    /// Derivative of matrix_at by the time; at the keys, and before and after both, that of the
    /// movement at the nearer key. Zero where nothing moves.
    Matrix4 rate(float time) const;
    /// Velocity at `time` of the material point that is at world position `p` then, per unit of
    /// time. Zero outside the keys and where nothing moves.
    Vec3 velocity(Vec3 p, float time) const;
    /// Angular velocity (world axes, radians per unit of time) of the rotation at `time`.
    Vec3 angular_velocity(float time) const;
    /// A box that holds `b` moved over all times (sampled finely, padded by what lies between).
    Bounds3 motion_bounds(const Bounds3& b) const;

  private:
    /// Data of moving transforms, kept apart and shared, as most transforms of a scene rest.
    struct Movement;
    Transform start_;
    float start_time_ = 0, end_time_ = 1;
    std::shared_ptr<const Movement> movement_;  ///< null where it rests
};

}  // namespace covtrace
