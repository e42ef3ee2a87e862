/// The bodies that the query of occluders searches: the edges of all shapes in hierarchies, and
/// where in the world they stand. Only for query.cpp.
#pragma once

#include <functional>
#include <vector>

#include "geometry/placed_scene.h"
#include "geometry/tessellation.h"
#include "occluders/ball_block.h"
#include "occluders/blind_cones.h"
#include "occluders/box_hierarchy.h"
#include "occluders/edge_block.h"
#include "occluders/fold_edges.h"
#include "occluders/query.h"

namespace covtrace {

/// The edges of one body, in the local space of a scene of Embree.
struct EdgeSet {
    size_t count = 0;
    BoxHierarchy hierarchy;
    std::vector<EdgeBlock> blocks;  ///< its items, in their order
    std::vector<BlindCones> cones;  ///< for each node of the hierarchy

    explicit EdgeSet(const std::vector<FoldEdge>& found);
};

/// An edge set, or balls, somewhere in the world.
struct OccluderBody {
    enum class Kind { edges, balls, moving_ball };
    Kind kind = Kind::edges;
    uint32_t index = 0;                        ///< into `sets` or `balls`
    Vec3 center;                               ///< of a moving ball, local
    float radius = 0;                          ///< of a moving ball, local
    const EmbreeInstance* instance = nullptr;  ///< null: local space is world space
    OccluderQuery::Owner curved;  ///< the curved shape that this is; none for flat triangles
};

class OccluderBodies {
  public:
    OccluderBodies(const Geometry::Impl& geometry, std::function<bool()> cancelled);

    const Geometry::Impl& geometry;
    std::vector<EdgeSet> sets;
    std::vector<BallBlock> balls;      ///< that do not move
    std::vector<OccluderBody> bodies;  ///< in the order of `hierarchy`
    BoxHierarchy hierarchy;            ///< over the bodies, throughout the shutter

    /// A moving ball where it is at a time.
    OccluderBall moved(const OccluderBody& body, float time) const;

  private:
    using Owner = OccluderQuery::Owner;

    bool is_cancelled() const { return cancelled_ && cancelled_(); }
    bool has_holes(uint32_t shape) const;
    Tessellation perforated(uint32_t shape, const Affine& world_from_local) const;
    /// Whether an instance of each of Embree's scenes makes ellipsoids of its balls.
    std::vector<bool> deformed_scenes() const;
    std::vector<OccluderBody> add(const std::vector<uint32_t>& shapes,
                                  const Affine& world_from_local, bool are_deformed);
    void add_balls(const std::vector<OccluderBall>& all);
    void keep(FoldEdgeFinder& finder, const OccluderBody& body, std::vector<OccluderBody>& parts);
    double piece_of(const LocalShape& shape) const;
    bool keeps_angles(const EmbreeInstance& instance) const;
    Bounds3 bounds_of(const OccluderBody& body) const;

    std::function<bool()> cancelled_;
    double around_;  ///< pieces of a whole turn of curved shapes
    int per_edge_;   ///< pieces of the edges of shapes with holes
};

}  // namespace covtrace
