#include "geometry/outline_search.h"

#include <algorithm>

namespace covtrace {

namespace {

/// Edges so many times (squared) wider than the narrowest do not change what it allows.
constexpr float kFaint = 16;

}  // namespace

OutlineSearch::OutlineSearch(Vec3 begin, Vec3 end, const EdgeMeasure& measure, float nearest)
    : end_(end), measure_(measure), widest2_(measure.widest * measure.widest) {
    const float length = distance(begin, end);
    if (!(length > 0) || !std::isfinite(length)) return;
    const EdgeMeasure::Range range = measure.reach(length);
    lo_ = std::max(range.lo, nearest);
    hi_ = std::min(range.hi, length - nearest);
    axis_ = (begin - end) / length;
    frame_ = Frame::from_z(axis_);
    limit_ = widest2_;
}

void OutlineSearch::enter(const Affine& m) {
    for (size_t i = 0; i < 3; ++i) {
        rows_[i] = m.row[i].to_float();
        absolute_[i] = abs(m.row[i]).to_float();
    }
    shift_ = m.translation.to_float();
    local_end_ = m.inverse().point(Vec3d(end_)).to_float();
}

Float4 OutlineSearch::bound_world(const BoxHierarchy::Node& node) const {
    return bound({node.middle[0] - end_.x, node.middle[1] - end_.y, node.middle[2] - end_.z},
                 node.half);
}

Float4 OutlineSearch::bound_local(const BoxHierarchy::Node& node) const {
    std::array<Float4, 3> middle, half;
    for (size_t i = 0; i < 3; ++i) {
        const Vec3 r = rows_[i], a = absolute_[i];
        const int axis = static_cast<int>(i);
        middle[i] = r.x * node.middle[0] + r.y * node.middle[1] + r.z * node.middle[2] +
                    (shift_[axis] - end_[axis]);
        half[i] = a.x * node.half[0] + a.y * node.half[1] + a.z * node.half[2];
    }
    return bound(middle, half);
}

Float4 OutlineSearch::bound(const std::array<Float4, 3>& middle,
                            const std::array<Float4, 3>& half) const {
    const Vec3 w = axis_;
    const EdgeMeasure& m = measure_;
    const Float4 x = middle[0], y = middle[1], z = middle[2];
    const Float4 along = x * w.x + y * w.y + z * w.z;
    const Float4 reach =
        half[0] * std::abs(w.x) + half[1] * std::abs(w.y) + half[2] * std::abs(w.z);
    // Across the axis: the box lies beyond a plane at right angles to the way to its middle.
    const Float4 px = x - along * w.x, py = y - along * w.y, pz = z - along * w.z;
    const Float4 p2 = px * px + py * py + pz * pz;
    const Float4 inward = half[0] * abs4(px) + half[1] * abs4(py) + half[2] * abs4(pz);
    const Float4 beyond = max4(p2 - inward, Float4{});
    const Float4 r2 = beyond * beyond / (p2 + 1e-30f);
    const Float4 z0 = max4(along - reach, Float4{} + lo_), z1 = min4(along + reach, Float4{} + hi_);
    const Float4 a = m.a0 + m.a1 * z0, b = m.a0 + m.a1 * z1;
    const Float4 blur = a * b > 0 ? min4(a * a, b * b) : Float4{};
    const Float4 h = max4(max4(m.h0 + z0 * (m.h1 + z0 * m.h2), m.h0 + z1 * (m.h1 + z1 * m.h2)),
                          Float4{} + 1e-6f * m.h0);
    return z0 <= z1 ? (blur + m.b * r2) / h : Float4{} + kInfinity;
}

void OutlineSearch::meet(const FoldEdge& edge, Vec3 a, Vec3 b, Vec3 seen_from, uint32_t body) {
    const EdgeMeasure& m = measure_;
    const Vec3 from = a - end_, along = b - a;
    const float za = dot(from, axis_), dz = dot(along, axis_);
    // The part of the edge, t0 to t1 of its length, that lies beside the segment.
    float t0 = 0, t1 = 1;
    if (dz != 0) {
        const float ta = (lo_ - za) / dz, tb = (hi_ - za) / dz;
        t0 = std::max(t0, std::min(ta, tb));
        t1 = std::min(t1, std::max(ta, tb));
    } else if (za < lo_ || za > hi_) {
        return;
    }
    if (!(t0 <= t1)) return;
    const Vec3 p = from - axis_ * za, dp = along - axis_ * dz;
    const float blur = m.a0 + m.a1 * za;
    const float n0 = blur * blur + m.b * length_squared(p),
                n1 = 2 * (blur * m.a1 * dz + m.b * dot(p, dp)),
                n2 = sqr(m.a1 * dz) + m.b * length_squared(dp);
    const float h0 = m.denominator(za), h1 = (m.h1 + 2 * m.h2 * za) * dz, h2 = m.h2 * dz * dz;
    // Where the quotient of the two polynomials is stationary: again a quadratic.
    float best = kInfinity, best_t = t0;
    const auto attempt = [&](float t) {
        if (!(t >= t0 && t <= t1)) return;
        const float value = m.width_squared(za + t * dz, length_squared(p + dp * t));
        if (!(value < best)) return;
        best = value;
        best_t = t;
    };
    attempt(t0);
    attempt(t1);
    const float qa = n2 * h1 - n1 * h2, qb = n2 * h0 - n0 * h2, qc = n1 * h0 - n0 * h1;
    const float discriminant = qb * qb - qa * qc;
    if (discriminant >= 0) {
        const float q = -(qb + std::copysign(std::sqrt(discriminant), qb));
        if (qa != 0) attempt(q / qa);
        if (q != 0) attempt(qc / q);
    }
    if (!(best < limit_) || !edge.is_outline_from(seen_from)) return;

    Candidate c;
    c.width2 = best;
    c.body = body;
    c.event.z = za + best_t * dz;
    c.point = a + along * best_t;
    const Vec3 offset = p + dp * best_t;
    const Vec3 across = cross(along, axis_);  // at right angles to the edge as it is seen
    const float l = length(across), r = length(offset);
    const bool is_inside = best_t > t0 && best_t < t1;
    if (l > 0 && (is_inside || !(r > 1e-6f * c.event.z))) {
        const float side = dot(offset, across) / l;
        c.event.direction = across * (side < 0 ? -1 / l : 1 / l);
        c.event.distance = std::abs(side);
    } else if (r > 0) {
        c.event.direction = offset / r;
        c.event.distance = r;
    } else {
        return;  // seen end on, at a point: no direction
    }
    keep(c);
}

void OutlineSearch::keep(const Candidate& c) {
    // Sectors of 45 degrees of the line along the direction: quadrants of the doubled angle.
    const float x = dot(c.event.direction, frame_.x), y = dot(c.event.direction, frame_.y);
    const size_t sector = (x * x > y * y ? 0u : 1u) + (x * y > 0 ? 0u : 2u);
    if (!(c.width2 < best_[sector].width2)) return;
    best_[sector] = c;
    float least = kInfinity, most = 0;
    for (const Candidate& b : best_) {
        least = std::min(least, b.width2);
        most = std::max(most, b.width2);
    }
    limit_ = std::min({widest2_, most, kFaint * least});
}

}  // namespace covtrace
