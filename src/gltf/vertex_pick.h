/// Private to this folder: the vertices that a mesh keeps.
#pragma once

#include <vector>

#include "scene/scene_description.h"

namespace covtrace::gltf {

/// Gives a mesh the vertices with these indices, in this order, in place of its own; its triangles
/// stay as they are.
inline void pick_vertices(TriangleMesh& mesh, const std::vector<uint32_t>& kept) {
    const auto pick = [&kept](auto& values) {
        if (values.empty()) return;
        std::decay_t<decltype(values)> picked(kept.size());
        for (size_t k = 0; k < kept.size(); ++k) picked[k] = values[kept[k]];
        values = std::move(picked);
    };
    pick(mesh.positions);
    pick(mesh.normals);
    pick(mesh.uvs);
    pick(mesh.tangents);
    pick(mesh.colours);
    for (auto& uvs : mesh.more_uvs) pick(uvs);
}

}  // namespace covtrace::gltf
