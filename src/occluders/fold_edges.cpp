#include "occluders/fold_edges.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/frame.h"

namespace covtrace {

namespace {

constexpr uint32_t kFree = ~uint32_t{0};  // no corner: an empty slot
/// Least angle, radians, of a bend that casts an outline worth knowing.
constexpr float kLeastBend = 1e-3f;

std::array<uint32_t, 3> bits_of(Vec3 p) {
    // Hashes are of the bits; adding 0 makes -0 and +0, which compare equal, one place.
    return {std::bit_cast<uint32_t>(p.x + 0.0f), std::bit_cast<uint32_t>(p.y + 0.0f),
            std::bit_cast<uint32_t>(p.z + 0.0f)};
}

uint64_t hash_of(Vec3 p) {
    uint64_t h = 0x9e3779b97f4a7c15u;
    for (uint32_t b : bits_of(p)) {
        h = (h ^ b) * 0xbf58476d1ce4e5b9u;
        h ^= h >> 29;
    }
    return h;
}

/// The two directions, of those into the surfaces around an edge, between which all others lie.
struct Wedge {
    Vec3 first, last;
    /// Whether they are less than half a turn apart: otherwise the edge is no outline from
    /// anywhere.
    bool is_bent = false;
};

/// The wedge of a border, whose one direction is both, or of two faces. Directions are of unit
/// length and at right angles to the edge.
Wedge narrow_wedge(Vec3 first, Vec3 last) {
    // The sum of unit vectors that lack the angle e to being opposite is 2 sin(e / 2) long.
    return {first, last, length_squared(first + last) > sqr(kLeastBend)};
}

/// The wedge of any number of them: all but the widest gap between neighbours.
Wedge wide_wedge(Vec3 along, std::span<const Vec3> directions) {
    const Frame frame = Frame::from_z(along);
    std::vector<std::pair<float, Vec3>> sorted;
    for (const Vec3 d : directions)
        sorted.emplace_back(std::atan2(dot(d, frame.y), dot(d, frame.x)), d);
    std::sort(sorted.begin(), sorted.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    float widest = sorted.front().first + 2 * kPi - sorted.back().first;
    Wedge wedge{sorted.front().second, sorted.back().second};
    for (size_t i = 0; i + 1 < sorted.size(); ++i)
        if (sorted[i + 1].first - sorted[i].first > widest) {
            widest = sorted[i + 1].first - sorted[i].first;
            wedge = {sorted[i + 1].second, sorted[i].second};
        }
    wedge.is_bent = widest > kPi + kLeastBend;
    return wedge;
}

}  // namespace

FoldEdgeFinder::FoldEdgeFinder(size_t most) {
    sides_.reserve(3 * most);
    corners_.reserve(most);
    grow(std::bit_ceil(2 * most + 16));
}

uint32_t FoldEdgeFinder::weld(Vec3 position) {
    if (2 * (corners_.size() + 1) > table_.size()) grow(2 * table_.size());
    const size_t mask = table_.size() - 1;
    for (size_t i = hash_of(position) & mask;; i = (i + 1) & mask) {
        if (table_[i] == kFree) {
            table_[i] = static_cast<uint32_t>(corners_.size());
            corners_.push_back(position);
            return table_[i];
        }
        if (corners_[table_[i]] == position) return table_[i];
    }
}

void FoldEdgeFinder::grow(size_t slots) {
    table_.assign(slots, kFree);
    const size_t mask = table_.size() - 1;
    for (uint32_t c = 0; c < corners_.size(); ++c) {
        size_t i = hash_of(corners_[c]) & mask;
        while (table_[i] != kFree) i = (i + 1) & mask;
        table_[i] = c;
    }
}

void FoldEdgeFinder::add(const std::array<Vec3, 3>& corners, const Wanted& wanted) {
    for (const Vec3 p : corners)
        if (!is_finite(p)) return;
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) return;
    std::array<uint32_t, 3> welded{};
    for (size_t k = 0; k < 3; ++k) welded[k] = weld(corners[k]);
    for (size_t k = 0; k < 3; ++k)
        if (wanted[k]) {
            const auto [a, b] = std::minmax({welded[k], welded[(k + 1) % 3]});
            sides_.push_back({a, b, welded[(k + 2) % 3]});
        }
}

bool FoldEdgeFinder::find(std::span<const Side> sides, FoldEdge& edge) const {
    const Vec3 a = corners_[sides[0].a], b = corners_[sides[0].b], along = normalize(b - a);
    directions_.clear();
    for (const Side& s : sides) {
        const Vec3 d = corners_[s.opposite] - a, across = normalize(d - along * dot(d, along));
        if (across != Vec3{}) directions_.push_back(across);
    }
    if (along == Vec3{} || directions_.empty()) return false;
    const Wedge wedge = directions_.size() > 2
                            ? wide_wedge(along, directions_)
                            : narrow_wedge(directions_.front(), directions_.back());
    edge = {a, b, cross(along, wedge.first), cross(along, wedge.last)};
    return wedge.is_bent;
}

std::vector<FoldEdge> FoldEdgeFinder::edges() const {
    // Sides are sorted by the first corner of their edge.
    std::vector<uint32_t> first(corners_.size() + 1, 0);
    for (const Side& s : sides_) ++first[s.a + 1];
    for (size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    std::vector<Side> sides(sides_.size());
    std::vector<uint32_t> next(first.begin(), first.end() - 1);
    for (const Side& s : sides_) sides[next[s.a]++] = s;

    std::vector<FoldEdge> all;
    all.reserve(sides.size() / 2 + 1);
    for (size_t c = 0; c < corners_.size(); ++c) {
        const std::span of_corner = std::span(sides).subspan(first[c], first[c + 1] - first[c]);
        std::sort(of_corner.begin(), of_corner.end(), [](const Side& s, const Side& t) {
            return s.b < t.b || (s.b == t.b && s.opposite < t.opposite);
        });
        for (size_t i = 0, end = 0; i < of_corner.size(); i = end) {
            while (end < of_corner.size() && of_corner[end].b == of_corner[i].b) ++end;
            FoldEdge edge;
            if (find(of_corner.subspan(i, end - i), edge)) all.push_back(edge);
        }
    }
    return all;
}

}  // namespace covtrace
