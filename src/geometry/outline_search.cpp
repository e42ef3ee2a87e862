#include "geometry/outline_search.h"

#include <algorithm>
#include <bit>

#include "core/frame.h"

namespace covtrace {

namespace {

/// Edges so many times (squared) wider than the narrowest do not change what it allows.
constexpr float kFaint = 16;
/// What rounding may leave of a lower bound.
constexpr float kBelow = 0.999f;

}  // namespace

OutlineSearch::OutlineSearch(Vec3 begin, Vec3 end, const EdgeMeasure& measure, float nearest)
    : end_(end), measure_(measure), widest2_(measure.widest * measure.widest) {
    const float length = distance(begin, end);
    if (!(length > 0) || !std::isfinite(length)) return;
    const EdgeMeasure::Range range = measure.reach(length);
    lo_ = std::max(range.lo, nearest);
    hi_ = std::min(range.hi, length - nearest);
    axis_ = (begin - end) / length;
    limit_ = widest2_;
    if (is_over()) return;

    wide_end_ = all8(end_);
    wide_axis_ = all8(axis_);
    wide_size_ = abs8(wide_axis_);
    wide_lo_ = all8(lo_);
    wide_hi_ = all8(hi_);
    wide_a0_ = all8(measure.a0);
    wide_a1_ = all8(measure.a1);
    wide_b_ = all8(measure.b);
    wide_h0_ = all8(measure.h0);
    wide_h1_ = all8(measure.h1);
    wide_h2_ = all8(measure.h2);
    least_h_ = all8(1e-6f * measure.h0);
    wide_sharp_ = all8(measure.a1 != 0 ? -measure.a0 / measure.a1 : 0.0f);
}

void OutlineSearch::enter(const Affine& m) {
    for (size_t i = 0; i < 3; ++i) rows_[i] = m.row[i].to_float();
    shift_ = m.translation.to_float();
    local_end_ = m.inverse().point(Vec3d(end_)).to_float();
}

Float8 OutlineSearch::bound_local(const BoxHierarchy::Node& node, const BlindCones& cones) const {
    const auto row = [this](size_t i) { return all8(rows_[i]); };
    const Vec3x8 x = row(0), y = row(1), z = row(2), shift = all8(shift_ - end_);
    const Vec3x8 middle{dot8(x, node.middle) + shift.x, dot8(y, node.middle) + shift.y,
                        dot8(z, node.middle) + shift.z};
    const Vec3x8 half{dot8(abs8(x), node.half), dot8(abs8(y), node.half), dot8(abs8(z), node.half)};
    return cones.hide(node.middle - all8(local_end_)) ? all8(kInfinity) : bound(middle, half);
}

inline auto OutlineSearch::may_matter(const Vec3x8& from, const Vec3x8& along) const {
    const Float8 za = dot8(from, wide_axis_), dz = dot8(along, wide_axis_);
    // The part of the edge, t0 to t1 of its length, that lies beside the segment. Edges at right
    // angles to it have none or, by infinities, all.
    const Float8 ta = (wide_lo_ - za) / dz, tb = (wide_hi_ - za) / dz;
    const Float8 t0 = max8(min8(ta, tb), Float8{}), t1 = min8(max8(ta, tb), all8(1));
    const Float8 z0 = add_product8(t0, dz, za), z1 = add_product8(t1, dz, za);
    const Vec3x8 p = less_product8(wide_axis_, za, from), dp = less_product8(wide_axis_, dz, along);
    const Float8 nearest = min8(max8(-dot8(p, dp) / dot8(dp, dp), t0), t1);
    const Vec3x8 q = add_product8(dp, nearest, p);
    const Float8 lower = add_product8(wide_b_, dot8(q, q), least_blur2(min8(z0, z1), max8(z0, z1)));
    return (t0 <= t1) & (kBelow * lower < all8(limit_) * most_weight(z0, z1));
}

void OutlineSearch::meet_world(const EdgeBlock& edges, uint32_t body) {
    const Vec3x8 from = edges.a - wide_end_;
    const auto outlines = edges.may_be_outlines(from);
    if (bits8(outlines) == 0) return;
    for (unsigned left = bits8(outlines & may_matter(from, edges.along)); left != 0;
         left &= left - 1) {
        const FoldEdge edge = edges.edge(static_cast<size_t>(std::countr_zero(left)));
        meet(edge, edge.a, edge.b, end_, body);
    }
}

void OutlineSearch::meet_local(const EdgeBlock& edges, uint32_t body) {
    const auto outlines = edges.may_be_outlines(edges.a - all8(local_end_));
    if (bits8(outlines) == 0) return;
    const auto row = [this](size_t i) { return all8(rows_[i]); };
    const Vec3x8 x = row(0), y = row(1), z = row(2), shift = all8(shift_ - end_);
    const Vec3x8 from{dot8(x, edges.a) + shift.x, dot8(y, edges.a) + shift.y,
                      dot8(z, edges.a) + shift.z};
    const Vec3x8 along{dot8(x, edges.along), dot8(y, edges.along), dot8(z, edges.along)};
    for (unsigned left = bits8(outlines & may_matter(from, along)); left != 0; left &= left - 1) {
        const FoldEdge edge = edges.edge(static_cast<size_t>(std::countr_zero(left)));
        meet(edge, to_world(edge.a), to_world(edge.b), local_end_, body);
    }
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
    const float pdp = dot(p, dp), dp2 = length_squared(dp);
    const float blur = m.a0 + m.a1 * za;
    const float n0 = blur * blur + m.b * length_squared(p), n1 = 2 * (blur * m.a1 * dz + m.b * pdp),
                n2 = sqr(m.a1 * dz) + m.b * dp2;
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

void OutlineSearch::meet_ball(Vec3 center, float radius, uint32_t body) {
    const Vec3 d = center - end_;
    const float d2 = length_squared(d), tangent2 = d2 - radius * radius;
    if (!(tangent2 > 1e-4f * d2)) return;  // seen from inside, or from a point of it
    const Vec3 middle = d * (tangent2 / d2);
    const float rho = radius * std::sqrt(tangent2 / d2);
    // The circle's radius towards the axis, u, and v across both.
    const Vec3 towards = axis_ * d2 - d * dot(d, axis_);
    const float l = length(towards);
    const Vec3 u = l > 1e-6f * d2 ? towards / l : Frame::from_z(d / std::sqrt(d2)).x;
    const Vec3 v = cross(d / std::sqrt(d2), u);
    const float z_middle = dot(middle, axis_), z_slope = rho * dot(u, axis_);

    // Both halves are alike. Nearest to the axis is the angle 0; where the width falls along the
    // axis, or the range ends, it may be another.
    float best = kInfinity, best_cosine = 1;
    const auto attempt = [&](float cosine) {
        const float z = z_middle + cosine * z_slope;
        if (!(std::abs(cosine) <= 1) || z < lo_ || z > hi_) return;
        const Vec3 p = middle + u * (rho * cosine) + v * (rho * safe_sqrt(1 - cosine * cosine));
        const float value = measure_.width_squared(z, length_squared(p - axis_ * z));
        if (!(value < best)) return;
        best = value;
        best_cosine = cosine;
    };
    for (const float cosine : {1.0f, 0.7f, 0.0f, -0.7f, -1.0f}) attempt(cosine);
    // Just within the range.
    attempt((lo_ * 1.00001f - z_middle) / z_slope);
    attempt((hi_ * 0.99999f - z_middle) / z_slope);
    if (!(best < 2 * limit_)) return;
    for (float step = 0.25f; step > 0.01f; step *= 0.5f) {
        const float from = best_cosine;
        attempt(std::min(from + step, 1.0f));
        attempt(std::max(from - step, -1.0f));
    }
    if (!(best < limit_)) return;

    const float sine = safe_sqrt(1 - best_cosine * best_cosine);
    for (const float side : {1.0f, -1.0f}) {
        const Vec3 from_end = middle + u * (rho * best_cosine) + v * (side * rho * sine);
        Candidate c;
        c.width2 = best;
        c.body = body;
        c.event.z = dot(from_end, axis_);
        c.point = end_ + from_end;
        const Vec3 offset = from_end - axis_ * c.event.z;
        const Vec3 across = cross(v * best_cosine - u * (side * sine), axis_);
        const float a = length(across);
        if (!(a > 0)) return;
        const float beside = dot(offset, across) / a;
        c.event.direction = across * (beside < 0 ? -1 / a : 1 / a);
        c.event.distance = std::abs(beside);
        keep(c);
        if (sine == 0) return;
    }
}

void OutlineSearch::keep(const Candidate& c) {
    // Sectors of 45 degrees of the line along the direction: quadrants of the doubled angle.
    const Frame frame = Frame::from_z(axis_);
    const float x = dot(c.event.direction, frame.x), y = dot(c.event.direction, frame.y);
    const size_t sector = (x * x > y * y ? 0u : 1u) + (x * y > 0 ? 0u : 2u);
    if (!(c.width2 < best_[sector].width2)) return;
    best_[sector] = c;
    has_found_ = true;
    float least = kInfinity, most = 0;
    for (const Candidate& b : best_) {
        least = std::min(least, b.width2);
        most = std::max(most, b.width2);
    }
    limit_ = std::min({widest2_, most, kFaint * least});
}

}  // namespace covtrace
