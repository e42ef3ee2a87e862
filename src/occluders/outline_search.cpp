#include "occluders/outline_search.h"

#include <algorithm>
#include <bit>

#include "core/frame.h"

namespace covtrace {

namespace {

/// Ratio of an edge's squared width to that of the narrowest from which on the edge is left out:
/// one so much wider hardly narrows what the narrowest one lets through.
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
    limit_ = widest2_;
    if (is_over()) return;
    least_ = 1e-6f * measure.h0;
    sharp_ = measure.a1 != 0 ? -measure.a0 / measure.a1 : 0.0f;
}

void OutlineSearch::enter(const Affine& m) {
    if (has_found_) steps_left_ -= kStepsPerBody;
    for (size_t i = 0; i < 3; ++i) rows_[i] = m.row[i].to_float();
    shift_ = m.translation.to_float();
    local_end_ = m.inverse().point(Vec3d(end_)).to_float();
}

BoxHierarchy::Met OutlineSearch::near_local(const BoxHierarchy::Node& node) {
    const auto row = [this](size_t i) { return all8(rows_[i]); };
    const Vec3x8 x = row(0), y = row(1), z = row(2), shift = all8(shift_ - end_);
    const Vec3x8 middle{dot8(x, node.middle) + shift.x, dot8(y, node.middle) + shift.y,
                        dot8(z, node.middle) + shift.z};
    const Vec3x8 half{dot8(abs8(x), node.half), dot8(abs8(y), node.half), dot8(abs8(z), node.half)};
    return may_matter(middle, half);
}

BoxHierarchy::Met OutlineSearch::near_local(const BoxHierarchy::Node& node,
                                            const BlindCones& cones) {
    BoxHierarchy::Met met = near_local(node);
    met.bits &= ~bits8(cones.hide(node.middle - all8(local_end_)));
    return met;
}

template <class Distance>
inline OutlineSearch::Nearest OutlineSearch::nearest(const Curves& c,
                                                     const Distance& distance2) const {
    const EdgeMeasure& m = measure_;
    // Expand the width's numerator and denominator along the curve as polynomials in t.
    const Float8 a1 = all8(m.a1), b = all8(m.b), h2 = all8(m.h2);
    const Float8 blur = multiply_add(a1, c.z, all8(m.a0)), slope = a1 * c.dz;
    const Float8 n0 = multiply_add(blur, blur, b * c.r2),
                 n1 = 2 * multiply_add(blur, slope, b * c.dr2),
                 n2 = multiply_add(slope, slope, b * c.ddr2);
    const Float8 least = all8(least_);
    const Float8 bend = h2 * c.dz;
    const Float8 d0 = max8(multiply_add(multiply_add(h2, c.z, all8(m.h1)), c.z, all8(m.h0)), least),
                 d1 = multiply_add(2 * c.z, bend, m.h1 * c.dz), d2 = bend * c.dz;
    // Find the least width: the quotient's derivative has the sign of a quadratic, qa t^2 + 2 qb t
    // + qc, and the quotient is least where that crosses zero upwards.
    const Float8 qa = subtract_product(n1, d2, n2 * d1), qb = subtract_product(n0, d2, n2 * d0),
                 qc = subtract_product(n0, d1, n1 * d0);
    const Float8 root = sqrt8(subtract_product(qa, qc, qb * qb));
    const Mask8 rises = qb > Float8{};
    const Float8 valley = (rises ? -qc : root - qb) / (rises ? qb + root : qa);
    const Float8 t2 = min8(max8(valley, c.t0), c.t1);
    // Evaluate the width anew at t: near the axis the polynomials cancel, and only rounding would
    // be left of it.
    const auto width2 = [&](const Float8& t) {
        const Float8 z = multiply_add(t, c.dz, c.z);
        const Float8 a = multiply_add(a1, z, all8(m.a0));
        const Float8 h = multiply_add(multiply_add(h2, z, all8(m.h1)), z, all8(m.h0));
        return multiply_add(a, a, b * distance2(t)) / max8(h, least);
    };
    const Float8 w0 = width2(c.t0), w1 = width2(c.t1), w2 = width2(t2);
    const Float8 ends = min8(w0, w1), best = min8(ends, w2);
    const Float8 at = w2 < ends ? t2 : (w1 < w0 ? c.t1 : c.t0);
    return {c.t0 <= c.t1 ? best : all8(kInfinity), at, (at > c.t0) & (at < c.t1)};
}

inline OutlineSearch::Nearest OutlineSearch::nearest(const Vec3x8& from,
                                                     const Vec3x8& along) const {
    const Vec3x8 axis = all8(axis_);
    const Float8 za = dot8(from, axis), dz = dot8(along, axis);
    // Clip each edge to the part, t0 to t1 of its length, that lies beside the segment. Edges at
    // right angles to the segment have no such part or, by infinities, are kept whole.
    const Float8 ta = (all8(lo_) - za) / dz, tb = (all8(hi_) - za) / dz;
    const Float8 t0 = max8(min8(ta, tb), Float8{}), t1 = min8(max8(ta, tb), all8(1));
    const Vec3x8 p = subtract_product(axis, za, from), dp = subtract_product(axis, dz, along);
    return nearest({t0, t1, za, dz, dot8(p, p), dot8(p, dp), dot8(dp, dp)}, [&](const Float8& t) {
        const Vec3x8 q = multiply_add(dp, t, p);
        return dot8(q, q);
    });
}

void OutlineSearch::meet_world(const EdgeBlock& edges, uint32_t body) {
    const Vec3x8 from = edges.a - all8(end_);
    meet(edges.are_outlines(from), from, edges.along, body);
}

void OutlineSearch::meet_local(const EdgeBlock& edges, uint32_t body) {
    const auto row = [this](size_t i) { return all8(rows_[i]); };
    const Vec3x8 x = row(0), y = row(1), z = row(2), shift = all8(shift_ - end_);
    const Vec3x8 from{dot8(x, edges.a) + shift.x, dot8(y, edges.a) + shift.y,
                      dot8(z, edges.a) + shift.z};
    const Vec3x8 along{dot8(x, edges.along), dot8(y, edges.along), dot8(z, edges.along)};
    meet(edges.are_outlines(edges.a - all8(local_end_)), from, along, body);
}

inline void OutlineSearch::meet(const Mask8& outlines, const Vec3x8& from, const Vec3x8& along,
                                uint32_t body) {
    if (has_found_) --steps_left_;
    if (bits8(outlines) == 0) return;
    const Nearest nearest = this->nearest(from, along);
    unsigned left = bits8(outlines & (nearest.width2 < all8(limit_)));
    if (left == 0) return;
    const unsigned inside = bits8(nearest.inside);
    const Vec3x8 point = multiply_add(along, nearest.t, from);
    for (; left != 0; left &= left - 1) {
        const auto k = static_cast<size_t>(std::countr_zero(left));
        keep(nearest.width2[k], {point.x[k], point.y[k], point.z[k]},
             {along.x[k], along.y[k], along.z[k]}, (inside >> k & 1) != 0, body);
    }
}

void OutlineSearch::meet_balls(const BallBlock& balls, unsigned left_out, uint32_t body) {
    if (has_found_) steps_left_ -= kStepsPerBody;
    const Vec3x8 axis = all8(axis_), d = balls.center - all8(end_);
    // A ball's middle is at z = a and, in the direction e across the axis, x = q.
    const Float8 a = dot8(d, axis);
    // The part along the axis is taken out twice: what one subtraction leaves of a long way along
    // the axis and a short one across it is mostly rounding.
    const Vec3x8 about = subtract_product(axis, a, d),
                 across = subtract_product(axis, dot8(about, axis), about);
    const Float8 q2 = dot8(across, across), d2 = multiply_add(a, a, q2);
    const Float8 tangent2 = subtract_product(balls.radius, balls.radius, d2);
    // Leave out balls that are seen from inside, or from a point of their surface.
    const unsigned seen = bits8(tangent2 > 1e-4f * d2) & ~left_out;
    if (seen == 0) return;
    // The circle that outlines a ball, of radius rho, is at z + t dz along the axis, x + t dx along
    // e and sqrt(1 - t^2) rho to both sides of their plane, t from -1 to 1.
    const Float8 part = tangent2 / d2, distance = sqrt8(d2), q = sqrt8(q2);
    const Float8 rho = balls.radius * sqrt8(part), cosine = a / distance, sine = q / distance;
    const Float8 z = a * part, dz = rho * sine, x = q * part, dx = -rho * cosine;
    const Float8 t0 = max8((all8(lo_) - z) / dz, all8(-1)),
                 t1 = min8((all8(hi_) - z) / dz, all8(1));
    const auto height2 = [&](const Float8& t) { return max8(1 - t * t, Float8{}); };
    const Float8 rho2 = rho * rho;
    const Nearest nearest = this->nearest(
        {t0, t1, z, dz, multiply_add(x, x, rho2), x * dx, subtract_product(rho, rho, dx * dx)},
        [&](const Float8& t) {
            const Float8 e = multiply_add(t, dx, x);
            return multiply_add(e, e, rho2 * height2(t));
        });
    const unsigned near = seen & bits8(nearest.width2 < all8(limit_));
    if (near == 0) return;
    if (!has_found_) frame_ = Frame::from_z(axis_);
    const Mask8 is_beside = q > 1e-6f * distance;
    const auto unit = [&](const Float8& component, float otherwise) {
        return is_beside ? component / q : all8(otherwise);
    };
    const Vec3x8 e{unit(across.x, frame_.x.x), unit(across.y, frame_.x.y),
                   unit(across.z, frame_.x.z)},
        f = cross8(axis, e);
    const Float8 t = nearest.t, height = sqrt8(height2(t));
    const Float8 at_z = multiply_add(t, dz, z), at_e = multiply_add(t, dx, x);
    for (const float side : {1.0f, -1.0f}) {
        // The circle's tangent, turned by a right angle about the axis, and the point.
        const Float8 to_f = side * height * cosine, at_f = -side * height * rho;
        const Vec3x8 towards = multiply_add(f, to_f, multiply_add(e, t, Vec3x8{})),
                     point = multiply_add(axis, at_z,
                                          multiply_add(e, at_e, multiply_add(f, at_f, Vec3x8{})));
        unsigned left = near & bits8(nearest.width2 < widths2_of(towards));
        for (; left != 0; left &= left - 1) {
            const auto k = static_cast<size_t>(std::countr_zero(left));
            const Vec3 at{point.x[k], point.y[k], point.z[k]};
            Vec3 to{towards.x[k], towards.y[k], towards.z[k]};
            if (!(length_squared(to) > 0)) to = at - axis_ * at_z[k];
            keep(nearest.width2[k], {at, to, body});
        }
    }
}

/// Squared widths found so far in the sectors that eight directions are in.
inline Float8 OutlineSearch::widths2_of(const Vec3x8& towards) const {
    const Float8 x = dot8(towards, all8(frame_.x)), y = dot8(towards, all8(frame_.y));
    const auto of = [this](size_t sector) { return all8(widths2_[sector]); };
    const Mask8 rises = x * y > Float8{};
    return x * x > y * y ? (rises ? of(0) : of(2)) : (rises ? of(1) : of(3));
}

void OutlineSearch::keep(float width2, Vec3 point, Vec3 along, bool is_inside, uint32_t body) {
    if (!(width2 < limit_)) return;
    const float z = dot(point, axis_);
    const Vec3 offset = point - axis_ * z;
    Vec3 towards = cross(along, axis_);  // at right angles to the edge as it is seen
    if (!(length_squared(towards) > 0) || !(is_inside || length_squared(offset) <= sqr(1e-6f * z)))
        towards = offset;
    keep(width2, {point, towards, body});
}

void OutlineSearch::keep(float width2, const Candidate& candidate) {
    const Vec3 towards = candidate.towards;
    if (!(width2 < limit_)) return;
    if (!(length_squared(towards) > 0)) return;  // seen end on, at a point: no direction
    // Choose the sector of 45 degrees that the line along the direction lies in: it is the quadrant
    // of the doubled angle.
    if (!has_found_) frame_ = Frame::from_z(axis_);
    has_found_ = true;
    const float x = dot(towards, frame_.x), y = dot(towards, frame_.y);
    const size_t sector = (x * x > y * y ? 0u : 1u) + (x * y > 0 ? 0u : 2u);
    if (!(width2 < widths2_[sector])) return;
    widths2_[sector] = width2;
    best_[sector] = candidate;
    const auto [a, b, c, d] = widths2_;
    limit_ = std::min({widest2_, std::max(std::max(a, b), std::max(c, d)),
                       kFaint * std::min(std::min(a, b), std::min(c, d))});
}

}  // namespace covtrace
