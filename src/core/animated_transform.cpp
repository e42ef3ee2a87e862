#include <algorithm>
#include <cmath>

#include "core/decomposition.h"

namespace covtrace {

namespace {

using Matrix3 = std::array<std::array<double, 3>, 3>;

Matrix3 to_matrix(Quaternion q) {
    const double x = q.x, y = q.y, z = q.z, w = q.w;
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

}  // namespace

Quaternion slerp(double t, Quaternion a, Quaternion b) {
    double c = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
    if (c < 0) {
        b = {-b.x, -b.y, -b.z, -b.w};
        c = -c;
    }
    double wa = 1 - t, wb = t;
    if (c < 1 - 1e-12) {
        const double angle = std::acos(std::min(1.0, c)), s = std::sin(angle);
        wa = std::sin((1 - t) * angle) / s;
        wb = std::sin(t * angle) / s;
    }
    return {wa * a.x + wb * b.x, wa * a.y + wb * b.y, wa * a.z + wb * b.z, wa * a.w + wb * b.w};
}

struct AnimatedTransform::Movement {
    Transform end;
    std::array<Decomposition, 2> keys;
};

AnimatedTransform::AnimatedTransform(const Transform& start, float start_time, const Transform& end,
                                     float end_time)
    : start_(start), start_time_(start_time), end_time_(end_time) {
    if (start == end || !(end_time > start_time)) return;
    movement_ = std::make_shared<const Movement>(
        Movement{end, {polar_decomposition(start.matrix()), polar_decomposition(end.matrix())}});
}

const Transform& AnimatedTransform::end() const {
    return movement_ ? movement_->end : start_;
}

Transform AnimatedTransform::at(float time) const {
    if (!movement_ || time <= start_time_) return start_;
    if (time >= end_time_) return movement_->end;
    const auto moved = Transform::from_matrix(matrix_at(time));
    return moved ? *moved : start_;
}

Matrix4 AnimatedTransform::matrix_at(float time) const {
    if (!movement_ || time <= start_time_) return start_.matrix();
    if (time >= end_time_) return movement_->end.matrix();
    const auto& keys = movement_->keys;
    const double t = (double(time) - start_time_) / (double(end_time_) - start_time_);
    const Matrix3 rotation = to_matrix(slerp(t, keys[0].rotation, keys[1].rotation));
    Matrix4 m;
    for (size_t i = 0; i < 3; ++i) {
        for (size_t j = 0; j < 3; ++j) {
            double s = 0;
            for (size_t k = 0; k < 3; ++k)
                s += rotation[i][k] * ((1 - t) * keys[0].stretch[k][j] + t * keys[1].stretch[k][j]);
            m.m[i][j] = s;
        }
        m.m[i][3] = (1 - t) * keys[0].translation[int(i)] + t * keys[1].translation[int(i)];
    }
    return m;
}

Matrix4 AnimatedTransform::rate(float time) const {
    Matrix4 m;
    for (auto& row : m.m) row = {};
    if (!movement_) return m;
    const auto& keys = movement_->keys;
    const double per_time = 1 / (double(end_time_) - start_time_);
    const double t = std::clamp((double(time) - start_time_) * per_time, 0.0, 1.0);
    // The slerp has the weights sin((1 - t) angle) / sin(angle) and sin(t angle) / sin(angle);
    // their derivatives by t come with them.
    const Quaternion& a = keys[0].rotation;
    Quaternion b = keys[1].rotation;
    double c = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
    if (c < 0) {
        b = {-b.x, -b.y, -b.z, -b.w};
        c = -c;
    }
    double wa = 1 - t, wb = t, da = -1, db = 1;
    if (c < 1 - 1e-12) {
        const double angle = std::acos(c), sine = std::sqrt(1 - c * c);
        const double s = std::sin(t * angle), cosine = std::cos(t * angle);
        wa = cosine - s * c / sine;
        wb = s / sine;
        da = -angle * (s + cosine * c / sine);
        db = angle * cosine / sine;
    }
    const Quaternion q{wa * a.x + wb * b.x, wa * a.y + wb * b.y, wa * a.z + wb * b.z,
                       wa * a.w + wb * b.w};
    const Quaternion d{da * a.x + db * b.x, da * a.y + db * b.y, da * a.z + db * b.z,
                       da * a.w + db * b.w};
    const double xx = 2 * q.x * d.x, yy = 2 * q.y * d.y, zz = 2 * q.z * d.z;
    const double xy = q.x * d.y + d.x * q.y, xz = q.x * d.z + d.x * q.z, yz = q.y * d.z + d.y * q.z,
                 wx = q.w * d.x + d.w * q.x, wy = q.w * d.y + d.w * q.y, wz = q.w * d.z + d.w * q.z;
    const Matrix3 turning{{{-2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy)},
                           {2 * (xy + wz), -2 * (xx + zz), 2 * (yz - wx)},
                           {2 * (xz - wy), 2 * (yz + wx), -2 * (xx + yy)}}};
    const Matrix3 rotation = to_matrix(q);
    for (size_t i = 0; i < 3; ++i) {
        for (size_t j = 0; j < 3; ++j) {
            double s = 0;
            for (size_t k = 0; k < 3; ++k) {
                const double change = keys[1].stretch[k][j] - keys[0].stretch[k][j];
                s += turning[i][k] * (keys[0].stretch[k][j] + t * change) + rotation[i][k] * change;
            }
            m.m[i][j] = per_time * s;
        }
        m.m[i][3] = per_time * (double(keys[1].translation[int(i)]) - keys[0].translation[int(i)]);
    }
    return m;
}

Vec3 AnimatedTransform::velocity(Vec3 p, float time) const {
    if (!movement_ || time < start_time_ || time > end_time_) return {};
    const Vec3 local = at(time).inverse().point(p);
    const float h = 1e-3f * (end_time_ - start_time_);
    const float t0 = std::max(start_time_, time - h), t1 = std::min(end_time_, time + h);
    return (at(t1).point(local) - at(t0).point(local)) / (t1 - t0);
}

Vec3 AnimatedTransform::angular_velocity(float time) const {
    if (!movement_ || time < start_time_ || time > end_time_) return {};
    Quaternion a = movement_->keys[0].rotation, b = movement_->keys[1].rotation;
    if (a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w < 0) b = {-b.x, -b.y, -b.z, -b.w};
    // The quaternion b a^-1 turns the first key into the second; its axis is fixed in the world
    // during a slerp.
    const Quaternion c{-a.x, -a.y, -a.z, a.w};
    const double x = b.w * c.x + b.x * c.w + b.y * c.z - b.z * c.y;
    const double y = b.w * c.y - b.x * c.z + b.y * c.w + b.z * c.x;
    const double z = b.w * c.z + b.x * c.y - b.y * c.x + b.z * c.w;
    const double w = b.w * c.w - b.x * c.x - b.y * c.y - b.z * c.z;
    const double s = std::sqrt(x * x + y * y + z * z);
    if (!(s > 0)) return {};
    const double rate = 2 * std::atan2(s, w) / (double(end_time_) - start_time_) / s;
    return {static_cast<float>(x * rate), static_cast<float>(y * rate),
            static_cast<float>(z * rate)};
}

Bounds3 AnimatedTransform::motion_bounds(const Bounds3& b) const {
    Bounds3 all;
    const auto corner = [&b](int i) {
        return Vec3{i & 1 ? b.hi.x : b.lo.x, i & 2 ? b.hi.y : b.lo.y, i & 4 ? b.hi.z : b.lo.z};
    };
    const int steps = movement_ ? 64 : 0;
    float largest_step = 0;
    std::array<Vec3, 8> previous{};
    for (int s = 0; s <= steps; ++s) {
        const float f = steps ? float(s) / float(steps) : 0.0f;
        const Transform t = at(start_time_ + f * (end_time_ - start_time_));
        for (int i = 0; i < 8; ++i) {
            const Vec3 p = t.point(corner(i));
            if (s > 0) largest_step = std::max(largest_step, distance(p, previous[size_t(i)]));
            previous[size_t(i)] = p;
            all.extend(p);
        }
    }
    const float pad = 0.5f * largest_step;
    if (!all.empty()) {
        all.lo -= Vec3{pad, pad, pad};
        all.hi += Vec3{pad, pad, pad};
    }
    return all;
}

}  // namespace covtrace
