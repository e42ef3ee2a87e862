#include "occluders/outline_search.h"

#include <algorithm>
#include <bit>

#include "core/frame.h"

namespace covtrace {

namespace {

/// Ratio of squared widths from which on an edge is left out: one so much wider than the narrowest
/// does not change what that allows.
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

BoxHierarchy::Met OutlineSearch::near_local(const BoxHierarchy::Node& node,
                                            const BlindCones& cones) {
    const auto row = [this](size_t i) { return all8(rows_[i]); };
    const Vec3x8 x = row(0), y = row(1), z = row(2), shift = all8(shift_ - end_);
    const Vec3x8 middle{dot8(x, node.middle) + shift.x, dot8(y, node.middle) + shift.y,
                        dot8(z, node.middle) + shift.z};
    const Vec3x8 half{dot8(abs8(x), node.half), dot8(abs8(y), node.half), dot8(abs8(z), node.half)};
    BoxHierarchy::Met met = may_matter(middle, half);
    met.bits &= ~bits8(cones.hide(node.middle - all8(local_end_)));
    return met;
}

inline OutlineSearch::Nearest OutlineSearch::nearest(const Vec3x8& from,
                                                     const Vec3x8& along) const {
    const EdgeMeasure& m = measure_;
    const Vec3x8 axis = all8(axis_);
    const Float8 za = dot8(from, axis), dz = dot8(along, axis);
    // Clip each edge to the part, t0 to t1 of its length, that lies beside the segment. Edges at
    // right angles to the segment have no such part or, by infinities, are kept whole.
    const Float8 ta = (all8(lo_) - za) / dz, tb = (all8(hi_) - za) / dz;
    const Float8 t0 = max8(min8(ta, tb), Float8{}), t1 = min8(max8(ta, tb), all8(1));
    const Vec3x8 p = subtract_product(axis, za, from), dp = subtract_product(axis, dz, along);
    // Expand the width's numerator and denominator along the edge as polynomials in t.
    const Float8 a1 = all8(m.a1), b = all8(m.b), h2 = all8(m.h2);
    const Float8 blur = multiply_add(a1, za, all8(m.a0)), slope = a1 * dz;
    const Float8 p2 = dot8(p, p), pdp = dot8(p, dp), dp2 = dot8(dp, dp);
    const Float8 n0 = multiply_add(blur, blur, b * p2), n1 = 2 * multiply_add(blur, slope, b * pdp),
                 n2 = multiply_add(slope, slope, b * dp2);
    const Float8 least = all8(least_);
    const Float8 bend = h2 * dz;
    const Float8 d0 = max8(multiply_add(multiply_add(h2, za, all8(m.h1)), za, all8(m.h0)), least),
                 d1 = multiply_add(2 * za, bend, m.h1 * dz), d2 = bend * dz;
    // Find the least width: the quotient's derivative has the sign of a quadratic, qa t^2 + 2 qb t
    // + qc, and the quotient is least where that crosses zero upwards.
    const Float8 qa = subtract_product(n1, d2, n2 * d1), qb = subtract_product(n0, d2, n2 * d0),
                 qc = subtract_product(n0, d1, n1 * d0);
    const Float8 root = sqrt8(subtract_product(qa, qc, qb * qb));
    const Mask8 rises = qb > Float8{};
    const Float8 valley = (rises ? -qc : root - qb) / (rises ? qb + root : qa);
    const Float8 t2 = min8(max8(valley, t0), t1);
    // Evaluate the width anew at t: the polynomials would leave of points near the axis only
    // rounding.
    const auto width2 = [&](const Float8& t) {
        const Float8 z = multiply_add(t, dz, za);
        const Vec3x8 q = multiply_add(dp, t, p);
        const Float8 a = multiply_add(a1, z, all8(m.a0));
        const Float8 h = multiply_add(multiply_add(h2, z, all8(m.h1)), z, all8(m.h0));
        return multiply_add(a, a, b * dot8(q, q)) / max8(h, least);
    };
    const Float8 w0 = width2(t0), w1 = width2(t1), w2 = width2(t2);
    const Float8 ends = min8(w0, w1), best = min8(ends, w2);
    const Float8 at = w2 < ends ? t2 : (w1 < w0 ? t1 : t0);
    return {t0 <= t1 ? best : all8(kInfinity), at, (at > t0) & (at < t1)};
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

void OutlineSearch::meet_ball(Vec3 center, float radius, uint32_t body) {
    if (has_found_) steps_left_ -= kStepsPerBody;
    const Vec3 d = center - end_;
    const float d2 = length_squared(d), tangent2 = d2 - radius * radius;
    // Seen from inside, or from a point of the ball's surface.
    if (!(tangent2 > 1e-4f * d2)) return;
    const Vec3 middle = d * (tangent2 / d2);
    const float rho = radius * std::sqrt(tangent2 / d2);
    // The axes of the outline's circle: u points towards the segment's axis, v across.
    const Vec3 towards = axis_ * d2 - d * dot(d, axis_);
    const float l = length(towards);
    const Vec3 u = l > 1e-6f * d2 ? towards / l : Frame::from_z(d / std::sqrt(d2)).x;
    const Vec3 v = cross(d / std::sqrt(d2), u);
    const float z_middle = dot(middle, axis_), z_slope = rho * dot(u, axis_);

    // Search the place on the circle where the outline is narrowest, by its cosine to u: both
    // halves of the circle are alike. Nearest to the axis is the cosine 1; where the width falls
    // along the axis, or the range ends, another may be best.
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
    // Two more attempts lie just within the ends of the range.
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
        const Vec3 point = middle + u * (rho * best_cosine) + v * (side * rho * sine);
        keep(best, point, v * best_cosine - u * (side * sine), true, body);
        if (sine == 0) return;
    }
}

void OutlineSearch::keep(float width2, Vec3 point, Vec3 along, bool is_inside, uint32_t body) {
    if (!(width2 < limit_)) return;
    const float z = dot(point, axis_);
    const Vec3 offset = point - axis_ * z;
    Vec3 towards = cross(along, axis_);  // at right angles to the edge as it is seen
    if (!(length_squared(towards) > 0) || !(is_inside || length_squared(offset) <= sqr(1e-6f * z)))
        towards = offset;
    if (!(length_squared(towards) > 0)) return;  // seen end on, at a point: no direction
    // Choose the sector of 45 degrees that the line along the direction lies in: it is the quadrant
    // of the doubled angle.
    if (!has_found_) frame_ = Frame::from_z(axis_);
    has_found_ = true;
    const float x = dot(towards, frame_.x), y = dot(towards, frame_.y);
    const size_t sector = (x * x > y * y ? 0u : 1u) + (x * y > 0 ? 0u : 2u);
    if (!(width2 < widths2_[sector])) return;
    widths2_[sector] = width2;
    best_[sector] = {point, towards, body};
    const auto [a, b, c, d] = widths2_;
    limit_ = std::min({widest2_, std::max(std::max(a, b), std::max(c, d)),
                       kFaint * std::min(std::min(a, b), std::min(c, d))});
}

}  // namespace covtrace
