/// A place in a triangle of a mesh, for what textures read from its vertices.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "scene/scene_description.h"

namespace covtrace {

/// Whether textures or maps may read anything but (u, v) from the vertices of a mesh.
inline bool has_vertex_values(const TriangleMesh& mesh) {
    return !mesh.colours.empty() || !mesh.more_uvs.empty() || !mesh.map_signs.empty();
}

/// The surface's (u, v) at the three corners. As in pbrt, a triangle without coordinates has (0,
/// 0), (1, 0), (1, 1).
inline std::array<Vec2, 3> uv_corners(const TriangleMesh& mesh, uint32_t triangle) {
    if (mesh.uvs.empty()) return {Vec2{0, 0}, Vec2{1, 0}, Vec2{1, 1}};
    const auto& i = mesh.triangles[triangle];
    return {mesh.uvs[i[0]], mesh.uvs[i[1]], mesh.uvs[i[2]]};
}

/// A point of a triangle, by the mesh that has it and its barycentric coordinates.
struct VertexPlace {
    const TriangleMesh* mesh = nullptr;  ///< null: no mesh, or one without values at its vertices
    uint32_t triangle = 0;
    Vec2 barycentric;  ///< weights of the second and the third corner

    std::array<float, 3> weights() const {
        return {1 - barycentric.x - barycentric.y, barycentric.x, barycentric.y};
    }
    /// The values of the triangle's corners in a list that has one value per vertex.
    template <typename T>
    std::array<T, 3> corners(const std::vector<T>& values) const {
        const auto& i = mesh->triangles[triangle];
        return {values[i[0]], values[i[1]], values[i[2]]};
    }
    /// How the barycentric coordinates change with the surface's (u, v): {d b1 / d(u, v), d b2 /
    /// d(u, v)}, all 0 where (u, v) don't tell the triangle's points apart.
    std::array<Vec2, 2> barycentric_by_uv() const {
        const auto [uv0, uv1, uv2] = uv_corners(*mesh, triangle);
        const Vec2 d1 = uv1 - uv0, d2 = uv2 - uv0;
        const float determinant = d1.x * d2.y - d2.x * d1.y;
        const float inverse = 1 / determinant;
        if (!std::isfinite(inverse)) return {};
        return {Vec2{d2.y, -d2.x} * inverse, Vec2{-d1.y, d1.x} * inverse};
    }
};

}  // namespace covtrace
