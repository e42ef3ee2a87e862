/// Private to this folder: the meshes of nodes that morph targets and skins deform over the
/// shutter, as meshes that each move by one transform (gltf/moving_pieces.h).
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "gltf/geometry.h"
#include "gltf/nodes.h"

namespace covtrace::gltf {

/// A mesh and its way to world space.
struct MovedMesh {
    std::shared_ptr<const TriangleMesh> mesh;
    AnimatedTransform to_world;
};

class DeformedNodes {
  public:
    DeformedNodes(const Document& document, WarningLog& log, GeometryReader& geometry,
                  const PlacedNodes& placed, const Animations& animations,
                  std::array<float, 2> shutter)
        : document_(document),
          log_(log),
          geometry_(geometry),
          placed_(placed),
          animations_(animations),
          shutter_(shutter) {}

    /// Whether the node's mesh is deformed, by morph targets or a skin.
    bool deforms(const PlacedNode& node);
    /// One primitive of the node's mesh, deformed: one mesh that may move with the node, or pieces.
    std::vector<MovedMesh> meshes(const PlacedNode& node, size_t primitive,
                                  const VertexLayout& layout);

  private:
    /// A skin's joint matrices, from the mesh's space to the world's, at both ends of the shutter;
    /// empty without joints.
    using JointMatrices = std::array<std::vector<Matrix4>, 2>;

    const tinygltf::Node& node_of(const PlacedNode& node) const;
    const JointMatrices& joints_of(int skin, const std::string& place);
    JointMatrices read_joints(int skin, const std::string& place);

    const Document& document_;
    WarningLog& log_;
    GeometryReader& geometry_;
    const PlacedNodes& placed_;
    const Animations& animations_;
    const std::array<float, 2> shutter_;
    std::map<int, JointMatrices> skins_;
};

}  // namespace covtrace::gltf
