#include "gltf/deformed_nodes.h"

#include <algorithm>
#include <cmath>

#include "gltf/accessor.h"
#include "gltf/moving_pieces.h"

namespace covtrace::gltf {
namespace {

bool any(const std::vector<double>& weights) {
    return std::any_of(weights.begin(), weights.end(), [](double w) { return w != 0; });
}

/// The triangles of a piece as a mesh, with the vertices that they use, and the mesh's place in
/// `mesh`. Its origin is the middle of the piece or, where joints move it, the point that it turns
/// about: motions are interpolated as turns about the origin, and the origin goes straight.
std::pair<std::shared_ptr<const TriangleMesh>, Transform> part_of(
    const TriangleMesh& mesh, const std::vector<uint32_t>& triangles, const Matrix4& motion,
    bool is_skinned) {
    auto part = std::make_shared<TriangleMesh>();
    std::map<uint32_t, uint32_t> places;
    part->triangles.reserve(triangles.size());
    part->more_uvs.resize(mesh.more_uvs.size());
    for (const uint32_t t : triangles) {
        auto triangle = mesh.triangles[t];
        for (uint32_t& i : triangle) {
            const auto [it, is_new] =
                places.try_emplace(i, static_cast<uint32_t>(part->positions.size()));
            if (is_new) {
                part->positions.push_back(mesh.positions[i]);
                if (!mesh.normals.empty()) part->normals.push_back(mesh.normals[i]);
                if (!mesh.uvs.empty()) part->uvs.push_back(mesh.uvs[i]);
                if (!mesh.colours.empty()) part->colours.push_back(mesh.colours[i]);
                for (size_t set = 0; set < mesh.more_uvs.size(); ++set)
                    part->more_uvs[set].push_back(mesh.more_uvs[set][i]);
            }
            i = it->second;
        }
        part->triangles.push_back(triangle);
        if (!mesh.colour_steps.empty()) part->colour_steps.push_back(mesh.colour_steps[t]);
    }
    Bounds3 box;
    for (const Vec3& p : part->positions) box.extend(p);
    Vec3 origin = box.center();
    if (const auto turn = Transform::from_matrix(motion); is_skinned && turn)
        origin = pivot(*turn, origin);
    for (Vec3& p : part->positions) p = p - origin;
    return {part, Transform::translate(origin)};
}

}  // namespace

const tinygltf::Node& DeformedNodes::node_of(const PlacedNode& node) const {
    return document_.model.nodes[static_cast<size_t>(node.node)];
}

bool DeformedNodes::deforms(const PlacedNode& node) {
    const tinygltf::Node& n = node_of(node);
    const std::string place = element("nodes", static_cast<size_t>(node.node));
    if (n.skin >= 0 && !joints_of(n.skin, place)[0].empty()) return true;
    const auto& primitives =
        at(document_, document_.model.meshes, n.mesh, "meshes", place + ".mesh").primitives;
    const bool has_targets = std::any_of(primitives.begin(), primitives.end(),
                                         [](const auto& p) { return !p.targets.empty(); });
    return has_targets &&
           (any(morph_weights(document_, animations_, node.node, double(shutter_[0]))) ||
            any(morph_weights(document_, animations_, node.node, double(shutter_[1]))));
}

std::vector<MovedMesh> DeformedNodes::meshes(const PlacedNode& node, size_t primitive,
                                             const VertexLayout& layout) {
    const tinygltf::Node& n = node_of(node);
    const std::string place = element("nodes", static_cast<size_t>(node.node));
    static const JointMatrices kNone;
    const JointMatrices& joints = n.skin >= 0 ? joints_of(n.skin, place) : kNone;
    const auto at_end = [&](size_t end) {
        const auto weights =
            morph_weights(document_, animations_, node.node, double(shutter_[end]));
        return geometry_.deformed(n.mesh, primitive, layout, weights, joints[end], place);
    };
    const TriangleMesh open = at_end(0), close = at_end(1);
    // Joints place the vertices that they carry, whatever the node's own transform.
    const bool is_skinned = !joints[0].empty() && geometry_.has_joints(n.mesh, primitive, layout);
    const AnimatedTransform to_world = is_skinned ? AnimatedTransform(Transform()) : node.transform;
    if (open.positions == close.positions)
        return {{std::make_shared<TriangleMesh>(open), to_world}};
    const MovingPieces cut = moving_pieces(open.positions, close.positions, open.triangles);
    if (cut.left > kMostLeftSilently)
        log_.add(document_.place(place), "its mesh bends more while the shutter is open than " +
                                             std::to_string(cut.pieces.size()) +
                                             " pieces that each move as one can follow: " +
                                             std::to_string(std::lround(100 * cut.left)) +
                                             " % of the way are left out");
    std::vector<MovedMesh> result;
    for (const MovingPiece& piece : cut.pieces) {
        const auto [part, place_in_mesh] = part_of(open, piece.triangles, piece.motion, is_skinned);
        const Transform start = to_world.start() * place_in_mesh;
        const auto end =
            Transform::from_matrix(to_world.end().matrix() * piece.motion * place_in_mesh.matrix());
        result.push_back({part, end && !(end->matrix() == start.matrix())
                                    ? AnimatedTransform(start, shutter_[0], *end, shutter_[1])
                                    : AnimatedTransform(start)});
    }
    return result;
}

const DeformedNodes::JointMatrices& DeformedNodes::joints_of(int skin, const std::string& place) {
    const auto it = skins_.find(skin);
    if (it != skins_.end()) return it->second;
    return skins_.emplace(skin, read_joints(skin, place)).first->second;
}

DeformedNodes::JointMatrices DeformedNodes::read_joints(int skin, const std::string& place) {
    const auto& source = at(document_, document_.model.skins, skin, "skins", place + ".skin");
    const std::string here = element("skins", static_cast<size_t>(skin));
    const size_t count = source.joints.size();
    Numbers inverse;
    if (source.inverseBindMatrices >= 0) {
        inverse =
            read_numbers(document_, source.inverseBindMatrices, 16, here + ".inverseBindMatrices");
        if (inverse.count() < count)
            document_.refuse(here + ".inverseBindMatrices",
                             "has " + std::to_string(inverse.count()) +
                                 " elements; expected at least " + std::to_string(count) +
                                 ", one per joint");
    }
    JointMatrices result;
    for (size_t k = 0; k < count; ++k) {
        const std::string joint_place = here + "." + element("joints", k);
        at(document_, document_.model.nodes, source.joints[k], "nodes", joint_place);
        const auto& world = placed_.worlds[static_cast<size_t>(source.joints[k])];
        if (!world) {
            log_.add(document_.place(joint_place),
                     "the joint is not in the scene; meshes are rendered as they are bound");
            return {};
        }
        Matrix4 bind;
        if (inverse.components > 0)
            for (size_t i = 0; i < 16; ++i) bind.m[i % 4][i / 4] = double(inverse.element(k)[i]);
        for (size_t end = 0; end < 2; ++end) result[end].push_back((*world)[end] * bind);
    }
    return result;
}

}  // namespace covtrace::gltf
