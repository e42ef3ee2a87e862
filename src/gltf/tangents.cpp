#include "gltf/tangents.h"

#include <algorithm>

#include "gltf/accessor.h"

namespace covtrace::gltf {
namespace {

/// Whether the texture coordinates of a triangle run the other way round than its normal says:
/// then the y of a normal map that follows v is against normal x tangent.
bool is_mirrored(const TriangleMesh& mesh, size_t triangle) {
    if (mesh.uvs.empty()) return false;
    const auto& i = mesh.triangles[triangle];
    const Vec2 d1 = mesh.uvs[i[1]] - mesh.uvs[i[0]], d2 = mesh.uvs[i[2]] - mesh.uvs[i[0]];
    const Vec3 area = cross(mesh.positions[i[1]] - mesh.positions[i[0]],
                            mesh.positions[i[2]] - mesh.positions[i[0]]);
    const Vec3 normal = mesh.normals[i[0]] + mesh.normals[i[1]] + mesh.normals[i[2]];
    return (d1.x * d2.y - d2.x * d1.y < 0) != (dot(area, normal) < 0);
}

}  // namespace

void read_tangents(const Document& document, int accessor, TriangleMesh& mesh,
                   const std::string& place) {
    const Numbers n = read_numbers(document, accessor, 4, place);
    require_count(document, n.count(), mesh.positions.size(), place);
    mesh.tangents.resize(n.count());
    for (size_t i = 0; i < n.count(); ++i)
        mesh.tangents[i] = {n.element(i)[0], n.element(i)[1], n.element(i)[2]};
    // Maps follow v already: the signs hold where w says otherwise, which is seldom.
    mesh.map_signs.resize(mesh.triangles.size());
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const bool is_against = n.element(mesh.triangles[t][0])[3] < 0;
        mesh.map_signs[t] = is_against == is_mirrored(mesh, t) ? 1 : -1;
    }
    if (std::ranges::all_of(mesh.map_signs, [](int8_t s) { return s > 0; })) mesh.map_signs.clear();
}

}  // namespace covtrace::gltf
