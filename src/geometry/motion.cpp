#include "geometry/motion.h"

#include <algorithm>

#include "core/error.h"

namespace covtrace {

namespace {

bool moves_between(const AnimatedTransform* t, float begin, float end) {
    return t && t->is_animated() && begin < end && t->start_time() < end && t->end_time() > begin;
}

}  // namespace

ShutterClock::ShutterClock(float open, float close, const std::vector<float>& key_times)
    : breaks_{open, close} {
    for (float key : key_times)
        if (key > open && key < close) breaks_.push_back(key);
    std::sort(breaks_.begin(), breaks_.end());
    if (close > open) breaks_.erase(std::unique(breaks_.begin(), breaks_.end()), breaks_.end());
    if (segments() > 128)
        throw Error(ErrorKind::limit,
                    "more than 128 different times at which motions start or stop");
}

float ShutterClock::key_time(unsigned i, unsigned count) const {
    const unsigned per_segment = count / segments(), segment = i / per_segment;
    if (segment == segments()) return close();
    const float f = static_cast<float>(i % per_segment) / static_cast<float>(per_segment);
    return breaks_[segment] + f * (breaks_[segment + 1] - breaks_[segment]);
}

Transform Motion::at(float time) const {
    if (!outer) return inner ? inner->at(time) : Transform{};
    return inner ? outer->at(time) * inner->at(time) : outer->at(time);
}

bool Motion::moves(float begin, float end) const {
    return moves_between(outer, begin, end) || moves_between(inner, begin, end);
}

Affine Motion::rate(float time, const ShutterClock& clock) const {
    // Find the segment between two breaks that holds `time`, without an allocation.
    float lo = clock.open(), hi = clock.close();
    for (const AnimatedTransform* t : {outer, inner}) {
        if (!t || !t->is_animated()) continue;
        for (float key : {t->start_time(), t->end_time()}) {
            if (key <= time) lo = std::max(lo, key);
            if (key > time) hi = std::min(hi, key);
        }
    }
    if (time >= clock.close()) {
        // The shutter's last instant belongs to the movement that it ends.
        lo = clock.open();
        for (const AnimatedTransform* t : {outer, inner})
            if (t && t->is_animated())
                for (float key : {t->start_time(), t->end_time()})
                    if (key < clock.close()) lo = std::max(lo, key);
    }
    Affine zero;
    for (Vec3d& row : zero.row) row = {};
    if (!moves(lo, hi)) return zero;
    if (!outer) return Affine::from_matrix(inner->rate(time));
    if (!inner) return Affine::from_matrix(outer->rate(time));
    // The product rule gives (A B)' = A' B + A B'; the fourth row of a rate is zero.
    Affine r = zero;
    const auto add = [&r](const Matrix4& a, const Matrix4& b) {
        const Affine product = Affine::from_matrix(a * b);
        for (int i = 0; i < 3; ++i) r.row[i] = r.row[i] + product.row[i];
        r.translation = r.translation + product.translation;
    };
    if (moves_between(outer, lo, hi)) add(outer->rate(time), inner->matrix_at(time));
    if (moves_between(inner, lo, hi)) add(outer->matrix_at(time), inner->rate(time));
    return r;
}

}  // namespace covtrace
