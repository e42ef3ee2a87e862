/// The bodies that the query of occluders searches: the edges of all shapes in hierarchies, and
/// where in the world they stand. Only for query.cpp.
#pragma once

#include <deque>
#include <functional>
#include <vector>

#include "geometry/placed_scene.h"
#include "geometry/tessellation.h"
#include "occluders/ball_block.h"
#include "occluders/box_hierarchy.h"
#include "occluders/edge_clusters.h"
#include "occluders/query.h"

namespace covtrace {

/// Clusters of edges, or balls, somewhere in the world.
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
    std::deque<EdgeClusters> sets;
    std::vector<BallBlock> balls;      ///< that do not move
    std::vector<OccluderBody> bodies;  ///< in the order of `hierarchy`
    BoxHierarchy hierarchy;            ///< over the bodies, throughout the shutter

    /// A moving ball where it is at a time.
    OccluderBall moved(const OccluderBody& body, float time) const;

  private:
    using Owner = OccluderQuery::Owner;

    bool is_cancelled() const { return cancelled_ && cancelled_(); }
    bool has_holes(uint32_t shape) const;
    OccluderSurface flat_surface(uint32_t shape, const Affine& world_from_local) const;
    /// Whether an instance of each of Embree's scenes makes ellipsoids of its balls.
    std::vector<bool> deformed_scenes() const;
    std::vector<OccluderBody> add(const std::vector<uint32_t>& shapes,
                                  const Affine& world_from_local, bool are_deformed);
    void add_balls(const std::vector<OccluderBall>& all);
    void keep(std::vector<OccluderSurface> surfaces, const OccluderBody& body,
              std::vector<OccluderBody>& parts);
    double piece_of(const LocalShape& shape) const;
    bool keeps_angles(const EmbreeInstance& instance) const;
    Bounds3 bounds_of(const OccluderBody& body) const;

    std::function<bool()> cancelled_;
    double around_;  ///< pieces of a whole turn of curved shapes
    int per_edge_;   ///< pieces of the edges of shapes with holes
};

}  // namespace covtrace
