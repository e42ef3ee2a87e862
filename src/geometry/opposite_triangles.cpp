#include "geometry/opposite_triangles.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>

namespace covtrace {
namespace {

using Triangle = std::array<uint32_t, 3>;

/// Most triangles on each other that are searched for one that looks the other way.
constexpr size_t kMostAlike = 16;

bool is_before(Vec3 a, Vec3 b) {
    return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
}

/// The corners of a triangle in an order that does not depend on the file's, and whether they run
/// around it the other way than in the file.
struct Sorted {
    std::array<Vec3, 3> corners;
    bool is_turned = false;
    bool has_area = true;  ///< whether all three differ

    Sorted(const TriangleMesh& mesh, const Triangle& triangle)
        : corners{mesh.positions[triangle[0]], mesh.positions[triangle[1]],
                  mesh.positions[triangle[2]]} {
        for (const size_t i : {0u, 1u, 0u})
            if (is_before(corners[i + 1], corners[i])) {
                std::swap(corners[i], corners[i + 1]);
                is_turned = !is_turned;
            }
        has_area = is_before(corners[0], corners[1]) && is_before(corners[1], corners[2]);
    }

    uint64_t hash() const {
        uint64_t h = 0xcbf29ce484222325u;
        for (const Vec3& corner : corners)
            for (const float f : {corner.x, corner.y, corner.z}) {
                const float positive_zero = f + 0.0f;
                uint32_t bits = 0;
                std::memcpy(&bits, &positive_zero, sizeof bits);
                h = (h ^ bits) * 0x9e3779b97f4a7c15u;
                h ^= h >> 29;
            }
        return h;
    }
};

}  // namespace

std::shared_ptr<const OppositeTriangles> OppositeTriangles::of(const TriangleMesh& mesh) {
    const size_t count = mesh.triangles.size();
    std::vector<std::pair<uint64_t, uint32_t>> by_hash(count);
    for (size_t i = 0; i < count; ++i)
        by_hash[i] = {Sorted(mesh, mesh.triangles[i]).hash(), static_cast<uint32_t>(i)};
    std::sort(by_hash.begin(), by_hash.end());

    auto found = std::make_shared<OppositeTriangles>();
    found->opposite_.resize(count);
    std::iota(found->opposite_.begin(), found->opposite_.end(), 0u);
    bool has_pairs = false;
    for (size_t i = 0; i + 1 < count; ++i) {
        if (by_hash[i].first != by_hash[i + 1].first) continue;
        const uint32_t first = by_hash[i].second;
        const Sorted a(mesh, mesh.triangles[first]);
        if (!a.has_area || found->opposite_[first] != first) continue;
        const size_t end = std::min(count, i + 1 + kMostAlike);
        for (size_t k = i + 1; k < end && by_hash[k].first == by_hash[i].first; ++k) {
            const uint32_t second = by_hash[k].second;
            const Sorted b(mesh, mesh.triangles[second]);
            if (a.corners != b.corners || a.is_turned == b.is_turned) continue;
            found->opposite_[first] = second;
            found->opposite_[second] = first;
            has_pairs = true;
            break;
        }
    }
    return has_pairs ? found : nullptr;
}

std::pair<uint32_t, Vec2> OppositeTriangles::at(const TriangleMesh& mesh, uint32_t primitive,
                                                Vec2 barycentric) const {
    const uint32_t other = opposite_[primitive];
    if (other == primitive) return {primitive, barycentric};
    const Triangle &from = mesh.triangles[primitive], &to = mesh.triangles[other];
    const std::array weights{1 - barycentric.x - barycentric.y, barycentric.x, barycentric.y};
    const auto weight_of = [&](uint32_t vertex) {
        size_t corner = 0;
        while (corner < 2 && mesh.positions[from[corner]] != mesh.positions[vertex]) ++corner;
        return weights[corner];
    };
    return {other, {weight_of(to[1]), weight_of(to[2])}};
}

}  // namespace covtrace
