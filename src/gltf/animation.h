/// Private to this folder: the poses of nodes at a time of the animations.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "core/transform.h"
#include "gltf/animated_properties.h"
#include "gltf/channel.h"
#include "gltf/document.h"

namespace covtrace::gltf {

/// Translation, rotation (x, y, z, w) and scale of a node.
struct Pose {
    std::array<double, 3> translation{0, 0, 0};
    std::array<double, 4> rotation{0, 0, 0, 1};
    std::array<double, 3> scale{1, 1, 1};
};

/// The matrix of a pose: scale, then rotation, then translation. The quaternion need not be
/// normalised.
Matrix4 matrix_of(const Pose& pose);

/// Animations of the file at once, on one time line in seconds. Where two move the same property,
/// the first one counts, with a warning.
class Animations {
  public:
    /// Reads and checks all channels of these animations.
    Animations(const Document& document, const std::vector<size_t>& played, WarningLog& log);

    bool empty() const { return channels_.empty() && properties_.empty(); }
    /// Time of the first and of the last key; there must be a channel.
    std::array<float, 2> span() const;
    /// Whether a channel places the node, morphs it, or both.
    bool moves(int node) const { return channels_.contains(node); }
    /// Weights of the node's morph targets at a time; empty where no channel moves them.
    std::vector<double> weights(int node, double time) const;
    /// Replaces the parts of `pose` that channels move by their values at `time`; beyond the first
    /// and last key these stay as there.
    void apply(int node, double time, Pose& pose) const;
    /// The channels of all but the poses of nodes.
    const AnimatedProperties& properties() const { return properties_; }

  private:
    enum class Path { translation, rotation, scale, weights };
    void read_channel(const Document& document, size_t animation, size_t channel, WarningLog& log);

    std::map<int, std::map<Path, Channel>> channels_;  ///< by node
    AnimatedProperties properties_;
};

}  // namespace covtrace::gltf
