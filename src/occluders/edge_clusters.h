/// The edges of one body in clusters of those that stand together. The edges of a cluster are found
/// when a search first comes by: most surfaces of a large scene are never near a segment for which
/// their outlines matter, and the images of others are so small that few of their parts are.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/error.h"
#include "geometry/pierced_triangle.h"
#include "geometry/tessellation.h"
#include "occluders/box_hierarchy.h"
#include "occluders/edge_set.h"

namespace covtrace {

/// The error where memory for outlines runs out.
inline Error no_memory_for_outlines() {
    return {ErrorKind::limit, "out of memory while collecting the scene's outlines"};
}

/// Triangles that occlude, or, where `holes` tells of any, the pieces of them that are left.
struct OccluderSurface {
    Tessellation triangles;
    /// A flat shape with holes: its triangles are those of `triangles`.
    struct Holes {
        const LocalShape* shape = nullptr;
        PiercedTriangle::IsOpaque is_opaque;
        int per_edge = 1;     ///< pieces of a triangle's edge
        size_t captured = 0;  ///< bytes that is_opaque keeps beside itself
    };
    std::optional<Holes> holes = {};
};

class EdgeClusters {
  public:
    /// Sorts triangles of one space into clusters; those with a corner that is not finite are
    /// dropped. Corners at the very same place are one, whichever surface they belong to. What a
    /// surface refers to must outlive this.
    explicit EdgeClusters(std::vector<OccluderSurface> surfaces);
    ~EdgeClusters();
    EdgeClusters(const EdgeClusters&) = delete;
    EdgeClusters& operator=(const EdgeClusters&) = delete;

    /// The hierarchy over the clusters, one an item.
    const BoxHierarchy& hierarchy() const { return hierarchy_; }
    /// The edges of a cluster, found now if they are not yet: the same ones whoever asks first.
    /// Thread-safe. Throws Error(limit) where memory runs out.
    const EdgeSet& edges(size_t item) const;
    /// Number of all edges. Finds those of all clusters.
    size_t count() const;
    size_t memory() const;  ///< bytes, of what was found so far

  private:
    /// One of the triangles that have an edge in a cluster.
    struct Reference {
        uint32_t surface = 0, triangle = 0;
    };

    void build_hierarchy(const std::vector<Bounds3>& boxes);
    template <class Body>
    void for_edge_owners(const Body& body) const;
    void add(const Reference& reference, uint32_t cluster, FoldEdgeFinder& finder) const;
    std::vector<FoldEdge> find(uint32_t cluster) const;

    std::vector<OccluderSurface> surfaces_;
    std::vector<size_t> first_corner_;  ///< for each surface, into cluster_of_
    std::vector<uint32_t> cluster_of_;  ///< of all corners of all surfaces
    std::vector<size_t> first_;         ///< for each cluster, into references_
    std::vector<Reference> references_;
    BoxHierarchy hierarchy_;
    std::vector<uint32_t> cluster_of_item_;
    mutable std::vector<std::atomic<const EdgeSet*>> found_;  ///< for each item of the hierarchy
};

}  // namespace covtrace
