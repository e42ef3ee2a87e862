#include "camera/film_rim.h"

#include <array>
#include <cmath>
#include <numbers>

namespace covtrace {

namespace {

constexpr int kWays = 16, kHalvings = 14;
/// Distance, pixels, below which single ways tell no direction: they end within what halving and
/// single precision resolve.
constexpr float kClose = 0.02f;

Vec2 direction(int k) {
    const float turn = 2 * kPi * float(k) / kWays;
    return {std::cos(turn), std::sin(turn)};
}

/// The point nearest to the origin of the line through two points.
Vec2 nearest_on_line(Vec2 a, Vec2 b) {
    const Vec2 along = b - a;
    const float square = dot(along, along);
    return square > 0 ? a - along * (dot(a, along) / square) : a;
}

}  // namespace

FilmRim::FilmRim(const Camera& camera, Vec2 low, Vec2 high) : camera_(camera) {
    // The lit part is convex: it holds the region where it holds the corners.
    const Vec2 a = low - Vec2{kReach, kReach}, b = high + Vec2{kReach, kReach};
    for (const Vec2 corner : {a, b, Vec2{a.x, b.y}, Vec2{b.x, a.y}})
        is_there_ = is_there_ || !sees(corner);
}

bool FilmRim::sees(Vec2 film) const {
    return camera_.generate_ray(film, {0.5f, 0.5f}, 0).sees;
}

bool FilmRim::holds_square(Vec2 film) const {
    constexpr float kCorner = kReach * std::numbers::sqrt2_v<float>;
    for (const Vec2 way :
         {Vec2{kCorner, 0}, Vec2{0, kCorner}, Vec2{-kCorner, 0}, Vec2{0, -kCorner}})
        if (!sees(film + way)) return false;
    return true;
}

std::optional<Vec2> FilmRim::way(Vec2 film) const {
    if (!is_there_ || holds_square(film) || !sees(film)) return std::nullopt;
    std::array<std::optional<Vec2>, kWays> ends;
    Vec2 outwards;
    std::optional<int> nearest;
    float least = kReach;
    for (int k = 0; k < kWays; ++k) {
        float inside = 0, outside = kReach;
        if (sees(film + direction(k) * outside)) continue;
        outwards = outwards + direction(k);
        for (int i = 0; i < kHalvings; ++i) {
            const float middle = (inside + outside) / 2;
            (sees(film + direction(k) * middle) ? inside : outside) = middle;
        }
        ends[size_t(k)] = direction(k) * outside;
        if (!nearest || outside < least) {
            nearest = k;
            least = outside;
        }
    }
    if (!nearest) return std::nullopt;
    if (least < kClose && length(outwards) > 0) return outwards * (least / length(outwards));
    // The rim is nearly straight between the ends of this way and of the nearer of its neighbours.
    const auto &end = ends[size_t(*nearest)],
               &before = ends[size_t((*nearest + kWays - 1) % kWays)],
               &after = ends[size_t((*nearest + 1) % kWays)];
    if (!before && !after) return end;
    const bool is_after = !before || (after && length(*after) < length(*before));
    return nearest_on_line(*end, is_after ? *after : *before);
}

}  // namespace covtrace
