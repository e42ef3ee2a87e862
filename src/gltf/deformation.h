/// Private to this folder: vertices moved by morph targets and by the joints of a skin.
#pragma once

#include <span>
#include <vector>

#include "core/transform.h"
#include "gltf/document.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// What moves the vertices of one primitive, in the order of its mesh here.
struct Deformation {
    struct Target {
        std::vector<Vec3> positions, normals;  ///< differences; each may be empty
    };
    std::vector<Target> targets;
    size_t influences = 0;         ///< joints per vertex; 0: it has none
    std::vector<uint32_t> joints;  ///< into the skin's, `influences` per vertex
    std::vector<float> weights;    ///< likewise; they sum to 1
};

/// Reads it of a primitive. `kept`: which of the file's `count` vertices the mesh consists of;
/// empty: all. Refuses what doesn't fit the vertices.
Deformation read_deformation(const Document& document, const tinygltf::Primitive& primitive,
                             size_t count, std::span<const uint32_t> kept,
                             const std::string& place);

/// `rest` with positions and normals as they are with these weights of the targets (missing ones
/// are 0) and these joint matrices. Without joints it stays in the node's space, with them it goes
/// to world space: glTF 2.0, 3.7.3.3 and 3.7.2.2. Refuses, at `place`, joints that the skin has not
/// and vertices that leave what floats hold.
TriangleMesh deform(const Document& document, const TriangleMesh& rest,
                    const Deformation& deformation, std::span<const double> weights,
                    std::span<const Matrix4> joints, const std::string& place);

}  // namespace covtrace::gltf
