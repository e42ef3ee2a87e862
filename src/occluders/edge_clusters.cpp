#include "occluders/edge_clusters.h"

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <span>

namespace covtrace {

namespace {

constexpr uint32_t kNoCluster = ~uint32_t{0};
/// Most corners of a cluster, those of pieces among them, but where many belong to one place.
constexpr size_t kMostCorners = 512;

struct Corner {
    Vec3 place;
    uint32_t pieces = 1;  ///< about how many corners of pieces it stands for
    size_t index = 0;     ///< among the corners of all surfaces
};

/// Numbers clusters of corners. Which one a corner falls into depends on its place alone: ranges
/// are cut by planes.
class CornerClusters {
  public:
    explicit CornerClusters(std::vector<uint32_t>& cluster_of) : cluster_of_(cluster_of) {}

    void cut(std::span<Corner> corners) {
        if (corners.empty()) return;
        Bounds3 bounds;
        size_t all = 0;
        for (const Corner& c : corners) {
            bounds.extend(c.place);
            all += c.pieces;
        }
        const Vec3 size = bounds.diagonal();
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const float lo = bounds.lo[axis], hi = bounds.hi[axis];
        if (all <= kMostCorners || lo == hi) {
            for (const Corner& c : corners) cluster_of_[c.index] = count_;
            ++count_;
            return;
        }
        // Between two floats next to each other there is no middle.
        const float middle = 0.5f * lo + 0.5f * hi, plane = middle > lo ? middle : hi;
        const auto above = std::partition(corners.begin(), corners.end(),
                                          [&](const Corner& c) { return c.place[axis] < plane; });
        const auto below = static_cast<size_t>(above - corners.begin());
        cut(corners.first(below));
        cut(corners.subspan(below));
    }
    uint32_t count() const { return count_; }

  private:
    std::vector<uint32_t>& cluster_of_;
    uint32_t count_ = 0;
};

/// An order of places: by x, then y, then z.
inline bool is_before(Vec3 a, Vec3 b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// The order of a triangle's corners by is_before(); none where two of them are at one place or
/// one is nowhere.
bool sort_corners(const std::array<Vec3, 3>& p, std::array<size_t, 3>& order) {
    if (!is_finite(p[0]) || !is_finite(p[1]) || !is_finite(p[2])) return false;
    order = {0, 1, 2};
    const auto swap_if = [&](size_t i, size_t j) {
        if (is_before(p[order[j]], p[order[i]])) std::swap(order[i], order[j]);
    };
    swap_if(0, 1);
    swap_if(1, 2);
    swap_if(0, 1);
    return is_before(p[order[0]], p[order[1]]) && is_before(p[order[1]], p[order[2]]);
}

}  // namespace

/// Calls body(cluster, reference, corners) for the triangles that have an edge in a cluster, with
/// the corners of these edges.
template <class Body>
void EdgeClusters::for_edge_owners(const Body& body) const {
    for (uint32_t s = 0; s < surfaces_.size(); ++s) {
        const Tessellation& surface = surfaces_[s].triangles;
        const auto& triangles = surface.triangles();
        for (uint32_t t = 0; t < triangles.size(); ++t) {
            const std::array<Vec3, 3> p = surface[t];
            std::array<size_t, 3> order;
            if (!sort_corners(p, order)) continue;
            const auto cluster = [&](size_t i) {
                return cluster_of_[first_corner_[s] + triangles[t][order[i]]];
            };
            // The first corner owns two edges, the second one the third, the last one none.
            const uint32_t c0 = cluster(0), c1 = cluster(1);
            body(c0, Reference{s, t}, p);
            if (c1 != c0)
                body(c1, Reference{s, t}, std::array{p[order[1]], p[order[2]], p[order[2]]});
        }
    }
}

EdgeClusters::EdgeClusters(std::vector<OccluderSurface> surfaces) : surfaces_(std::move(surfaces)) {
    size_t corner_count = 0;
    for (const OccluderSurface& surface : surfaces_) {
        first_corner_.push_back(corner_count);
        corner_count += surface.triangles.positions().size();
    }
    cluster_of_.assign(corner_count, kNoCluster);
    std::vector<Corner> corners;
    corners.reserve(corner_count);
    for (size_t s = 0; s < surfaces_.size(); ++s) {
        const Tessellation& surface = surfaces_[s].triangles;
        const int per_edge = surfaces_[s].holes ? surfaces_[s].holes->per_edge : 1;
        const auto pieces = static_cast<uint32_t>(std::max(1, per_edge * per_edge / 2));
        for (const auto& triangle : surface.triangles())
            for (const uint32_t k : triangle) {
                uint32_t& cluster = cluster_of_[first_corner_[s] + k];
                const Vec3 place = surface.positions()[k];
                if (cluster != kNoCluster || !is_finite(place)) continue;
                cluster = 0;
                corners.push_back({place, pieces, first_corner_[s] + k});
            }
    }
    CornerClusters clusters(cluster_of_);
    clusters.cut(corners);
    corners = {};

    first_.assign(clusters.count() + 1, 0);
    std::vector<Bounds3> boxes(clusters.count());
    for_edge_owners([&](uint32_t cluster, Reference, const std::array<Vec3, 3>& of_edges) {
        ++first_[cluster + 1];
        for (const Vec3 p : of_edges) boxes[cluster].extend(p);
    });
    for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    references_.resize(first_.back());
    std::vector<size_t> next(first_.begin(), first_.end() - 1);
    for_edge_owners([&](uint32_t cluster, Reference reference, const std::array<Vec3, 3>&) {
        references_[next[cluster]++] = reference;
    });
    build_hierarchy(boxes);
}

/// Builds the hierarchy over the clusters that own an edge; `boxes`: around the edges of each.
void EdgeClusters::build_hierarchy(const std::vector<Bounds3>& boxes) {
    std::vector<uint32_t> owners;
    std::vector<Bounds3> of_owners;
    for (uint32_t c = 0; c < boxes.size(); ++c)
        if (!boxes[c].empty()) {
            owners.push_back(c);
            of_owners.push_back(boxes[c]);
        }
    hierarchy_ = BoxHierarchy(of_owners);
    for (size_t i = 0; i < hierarchy_.items(); ++i)
        cluster_of_item_.push_back(owners[hierarchy_.item(i)[0]]);
    found_ = std::vector<std::atomic<const EdgeSet*>>(hierarchy_.items());
}

EdgeClusters::~EdgeClusters() {
    for (const auto& set : found_) delete set.load();
}

/// Adds a triangle, or its pieces, with the edges that a cluster owns. An edge of a triangle, and
/// all pieces of it, belongs to its first corner; edges between pieces belong to the first corner
/// of all.
void EdgeClusters::add(const Reference& reference, uint32_t cluster, FoldEdgeFinder& finder) const {
    const OccluderSurface& surface = surfaces_[reference.surface];
    const auto& triangle = surface.triangles.triangles()[reference.triangle];
    const std::array<Vec3, 3> p = surface.triangles[reference.triangle];
    const auto owns = [&](size_t k) {
        return cluster_of_[first_corner_[reference.surface] + triangle[k]] == cluster;
    };
    const auto first = [&](size_t k, size_t other) {
        return is_before(p[other], p[k]) ? other : k;
    };
    const FoldEdgeFinder::Wanted wanted{owns(first(0, 1)), owns(first(1, 2)), owns(first(2, 0))};
    if (!surface.holes) {
        finder.add(p, wanted);
        return;
    }
    const bool wants_inside = owns(first(first(0, 1), 2));
    const auto is_wanted = [&](size_t edge) {
        return edge == PiercedTriangle::kInside ? wants_inside : wanted[edge];
    };
    const OccluderSurface::Holes& holes = *surface.holes;
    for (const PiercedTriangle::Piece& piece :
         PiercedTriangle(*holes.shape, reference.triangle).pieces(holes.per_edge, holes.is_opaque))
        finder.add(piece.corners, {is_wanted(piece.edges[0]), is_wanted(piece.edges[1]),
                                   is_wanted(piece.edges[2])});
}

std::vector<FoldEdge> EdgeClusters::find(uint32_t cluster) const {
    const std::span references =
        std::span(references_).subspan(first_[cluster], first_[cluster + 1] - first_[cluster]);
    FoldEdgeFinder finder(references.size());
    for (const Reference& reference : references) add(reference, cluster, finder);
    return finder.edges();
}

const EdgeSet& EdgeClusters::edges(size_t item) const {
    std::atomic<const EdgeSet*>& found = found_[item];
    if (const EdgeSet* set = found.load(std::memory_order_acquire)) return *set;
    // Threads that come by at once find the same edges; all but one of them throw theirs away.
    std::unique_ptr<const EdgeSet> own;
    try {
        own = std::make_unique<const EdgeSet>(find(cluster_of_item_[item]));
    } catch (const std::bad_alloc&) {
        throw no_memory_for_outlines();
    }
    const EdgeSet* first = nullptr;
    return found.compare_exchange_strong(first, own.get(), std::memory_order_acq_rel)
               ? *own.release()
               : *first;
}

size_t EdgeClusters::count() const {
    size_t all = 0;
    for (size_t i = 0; i < found_.size(); ++i) all += edges(i).count;
    return all;
}

size_t EdgeClusters::memory() const {
    size_t bytes = sizeof *this + surfaces_.capacity() * sizeof(OccluderSurface) +
                   first_corner_.capacity() * sizeof(size_t) + hierarchy_.memory() +
                   cluster_of_.capacity() * sizeof(uint32_t) + first_.capacity() * sizeof(size_t) +
                   references_.capacity() * sizeof(Reference) +
                   found_.capacity() * sizeof found_[0] +
                   cluster_of_item_.capacity() * sizeof(uint32_t);
    for (const OccluderSurface& surface : surfaces_)
        bytes += surface.triangles.memory() + (surface.holes ? surface.holes->captured : 0);
    for (const auto& set : found_)
        if (const EdgeSet* s = set.load(std::memory_order_acquire)) bytes += s->memory();
    return bytes;
}

}  // namespace covtrace
