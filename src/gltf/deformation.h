/// Private to this folder: vertices moved by morph targets and by the joints of a skin.
#pragma once

#include <span>
#include <vector>

#include "core/transform.h"
#include "gltf/document.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// Morph targets and joints of one primitive's vertices, in the order of its mesh here.
struct Deformation {
    struct Target {
        std::vector<Vec3> positions, normals;  ///< differences from the mesh; each may be empty
    };
    std::vector<Target> targets;
    size_t influences = 0;         ///< joints per vertex; 0: there are none
    std::vector<uint32_t> joints;  ///< indices into the skin's joints, `influences` per vertex
    std::vector<float> weights;    ///< weight of each entry of `joints`; those of a vertex sum to 1
};

/// Reads the deformation of a primitive. `kept`: which of the file's `count` vertices the mesh
/// consists of; empty: all. Refuses data that don't fit the vertices.
Deformation read_deformation(const Document& document, const tinygltf::Primitive& primitive,
                             size_t count, std::span<const uint32_t> kept,
                             const std::string& place);

/// The mesh `rest` deformed: positions and normals as they are with these weights of the targets
/// (missing ones are 0) and these joint matrices. Without joints it stays in the node's space, with
/// them it goes to world space: glTF 2.0, sections 3.7.2.2 and 3.7.3.3. Refuses, at `place`, joints
/// that the skin has not and vertices that single precision can't hold.
TriangleMesh deform(const Document& document, const TriangleMesh& rest,
                    const Deformation& deformation, std::span<const double> weights,
                    std::span<const Matrix4> joints, const std::string& place);

}  // namespace covtrace::gltf
