#include "occluders/fold_edges.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/frame.h"
#include "core/parallel.h"

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

/// One triangle beside an edge, as stored with the edge's smaller corner.
struct Side {
    uint32_t other = 0;     ///< the edge's second corner, the larger
    uint32_t opposite = 0;  ///< the triangle's third corner
};

/// Makes the wedge that the triangles at the edge a-b fill, from their third corners. Returns false
/// where the edge is no outline from anywhere: it has no length, or no gap around it is wider than
/// pi.
bool wedge(Vec3 a, Vec3 b, const std::vector<Vec3>& corners, const Side* begin, const Side* end,
           FoldEdge& edge) {
    if (!(distance(a, b) > 0)) return false;
    const Frame frame = Frame::from_z(normalize(b - a));
    static thread_local std::vector<float> angles;
    angles.clear();
    for (const Side* s = begin; s != end; ++s) {
        const Vec3 d = corners[s->opposite] - a;
        const float x = dot(d, frame.x), y = dot(d, frame.y);
        if (x != 0 || y != 0) angles.push_back(std::atan2(y, x));
    }
    if (angles.empty()) return false;
    std::sort(angles.begin(), angles.end());
    // The wedge is all but the widest gap between neighbouring angles.
    float widest = angles.front() + 2 * kPi - angles.back();
    float first = angles.front(), last = angles.back();
    for (size_t i = 0; i + 1 < angles.size(); ++i)
        if (angles[i + 1] - angles[i] > widest) {
            widest = angles[i + 1] - angles[i];
            first = angles[i + 1];
            last = angles[i];
        }
    if (widest < kPi + kLeastBend) return false;
    const auto normal = [&frame](float angle) {
        return frame.y * std::cos(angle) - frame.x * std::sin(angle);
    };
    edge = {a, b, normal(first), normal(last)};
    return true;
}

}  // namespace

uint32_t FoldEdgeFinder::weld(Vec3 position) {
    if (2 * (corners_.size() + 1) > table_.size()) grow();
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

void FoldEdgeFinder::grow() {
    table_.assign(std::max<size_t>(1024, 2 * table_.size()), kFree);
    const size_t mask = table_.size() - 1;
    for (uint32_t c = 0; c < corners_.size(); ++c) {
        size_t i = hash_of(corners_[c]) & mask;
        while (table_[i] != kFree) i = (i + 1) & mask;
        table_[i] = c;
    }
}

void FoldEdgeFinder::add(const std::vector<Vec3>& positions,
                         const std::vector<std::array<uint32_t, 3>>& triangles) {
    std::vector<uint32_t> corner_of(positions.size(), kFree);
    for (const auto& t : triangles) {
        std::array<uint32_t, 3> corners{};
        bool finite = true;
        for (size_t k = 0; k < 3; ++k) {
            const Vec3 p = positions[t[k]];
            finite = finite && is_finite(p);
            if (!finite) break;
            uint32_t& c = corner_of[t[k]];
            if (c == kFree) c = weld(p);
            corners[k] = c;
        }
        if (finite && corners[0] != corners[1] && corners[1] != corners[2] &&
            corners[2] != corners[0])
            triangles_.push_back(corners);
    }
}

std::vector<FoldEdge> FoldEdgeFinder::take() {
    // Sides are sorted by the smaller corner of their edge.
    std::vector<uint32_t> first(corners_.size() + 1, 0);
    const auto for_sides = [this](const auto& body) {
        for (const auto& t : triangles_)
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t i = t[k], j = t[(k + 1) % 3];
                body(std::min(i, j), Side{std::max(i, j), t[(k + 2) % 3]});
            }
    };
    for_sides([&](uint32_t corner, Side) { ++first[corner + 1]; });
    for (size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    std::vector<Side> sides(first.back());
    std::vector<uint32_t> next(first.begin(), first.end() - 1);
    for_sides([&](uint32_t corner, Side side) { sides[next[corner]++] = side; });
    triangles_ = decltype(triangles_)();
    table_ = decltype(table_)();

    constexpr size_t kBlock = 8192;  // corners
    const size_t blocks = (corners_.size() + kBlock - 1) / kBlock;
    std::vector<std::vector<FoldEdge>> found(blocks);
    parallel_for(static_cast<int64_t>(blocks), [&](int64_t block) {
        const auto b = static_cast<size_t>(block);
        for (size_t c = b * kBlock; c < std::min(corners_.size(), (b + 1) * kBlock); ++c) {
            Side *begin = sides.data() + first[c], *end = sides.data() + first[c + 1];
            std::sort(begin, end, [](Side s, Side t) {
                return s.other < t.other || (s.other == t.other && s.opposite < t.opposite);
            });
            for (Side* group = begin; group != end;) {
                Side* last = group;
                while (last != end && last->other == group->other) ++last;
                FoldEdge edge;
                if (wedge(corners_[c], corners_[group->other], corners_, group, last, edge))
                    found[b].push_back(edge);
                group = last;
            }
        }
    });
    std::vector<FoldEdge> all;
    size_t count = 0;
    for (const auto& edges : found) count += edges.size();
    all.reserve(count);
    for (const auto& edges : found) all.insert(all.end(), edges.begin(), edges.end());
    corners_ = decltype(corners_)();
    return all;
}

}  // namespace covtrace
