#include "gltf/marks.h"

#include <cmath>

#include "core/frame.h"
#include "gltf/accessor.h"
#include "gltf/vertex_pick.h"

namespace covtrace::gltf {
namespace {

Bounds3 bounds_of(const Document& document, int mesh) {
    Bounds3 bounds;
    const auto& primitives = document.model.meshes[static_cast<size_t>(mesh)].primitives;
    for (size_t i = 0; i < primitives.size(); ++i) {
        const auto position = primitives[i].attributes.find("POSITION");
        if (position == primitives[i].attributes.end()) continue;
        const Numbers n = read_numbers(document, position->second, 3,
                                       element("meshes", static_cast<size_t>(mesh)) + "." +
                                           element("primitives", i) + ".attributes.POSITION");
        for (size_t k = 0; k < n.count(); ++k)
            bounds.extend(Vec3{n.element(k)[0], n.element(k)[1], n.element(k)[2]});
    }
    return bounds;
}

/// Mean factor by which a transform scales lengths.
float scale_of(const Transform& t) {
    const Vec3 origin = t.point({});
    const Vec3 x = t.point({1, 0, 0}) - origin, y = t.point({0, 1, 0}) - origin,
               z = t.point({0, 0, 1}) - origin;
    return std::cbrt(std::abs(dot(cross(x, y), z)));
}

/// Solids in the making.
struct Solids {
    std::vector<uint32_t> sources;
    std::vector<Vec3> offsets;
    std::vector<std::array<uint32_t, 3>> triangles;

    uint32_t add(uint32_t source, Vec3 offset) {
        sources.push_back(source);
        offsets.push_back(offset);
        return static_cast<uint32_t>(sources.size() - 1);
    }

    void add_point(uint32_t i, float radius) {
        // A tetrahedron as large as the ball has corners farther out; four are enough for a pixel.
        const float r = radius * (1.5f / std::sqrt(3.0f));
        const uint32_t a = add(i, {r, r, r}), b = add(i, {r, -r, -r}), c = add(i, {-r, r, -r}),
                       d = add(i, {-r, -r, r});
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
        triangles.push_back({a, d, b});
        triangles.push_back({b, d, c});
    }

    void add_line(uint32_t i, uint32_t k, Vec3 along, float radius) {
        const float size = length(along);
        if (!(size > 0) || !std::isfinite(size)) return;
        const Frame frame = Frame::from_z(along / size);
        std::array<uint32_t, 3> a{}, b{};
        for (size_t corner = 0; corner < 3; ++corner) {
            const float angle = 2 * kPi / 3 * static_cast<float>(corner);
            const Vec3 offset = radius * (frame.x * std::cos(angle) + frame.y * std::sin(angle));
            a[corner] = add(i, offset);
            b[corner] = add(k, offset);
        }
        triangles.push_back({a[0], a[2], a[1]});
        triangles.push_back(b);
        for (size_t corner = 0; corner < 3; ++corner) {
            const size_t next = (corner + 1) % 3;
            triangles.push_back({a[corner], a[next], b[next]});
            triangles.push_back({a[corner], b[next], b[corner]});
        }
    }
};

}  // namespace

bool has_marks(const tinygltf::Primitive& primitive) {
    return primitive.mode >= 0 && primitive.mode < TINYGLTF_MODE_TRIANGLES;
}

std::string told_of_marks(const tinygltf::Primitive& primitive) {
    const std::string shape = primitive.mode == TINYGLTF_MODE_POINTS
                                  ? "points are shown as tetrahedra"
                                  : "lines are shown as rods";
    const bool is_lit = primitive.attributes.contains("NORMAL");
    return shape + " of a thousandth of the scene's diagonal" +
           (is_lit ? "" : ", unlit, as they have no normals");
}

std::vector<float> mark_radii(const Document& document, const PlacedNodes& placed) {
    const auto mesh_of = [&](const PlacedNode& n) {
        const int mesh = document.model.nodes[static_cast<size_t>(n.node)].mesh;
        return mesh < static_cast<int>(document.model.meshes.size()) ? mesh : -1;
    };
    const auto& meshes = document.model.meshes;
    bool any = false;
    for (const PlacedNode& n : placed.nodes)
        if (const int mesh = mesh_of(n); mesh >= 0)
            for (const tinygltf::Primitive& p : meshes[static_cast<size_t>(mesh)].primitives)
                any = any || has_marks(p);
    if (!any) return {};
    std::vector<float> scales(meshes.size(), 0);
    std::vector<Bounds3> bounds(meshes.size());
    Bounds3 all;
    for (const PlacedNode& n : placed.nodes) {
        const int mesh = mesh_of(n);
        if (mesh < 0) continue;
        const auto m = static_cast<size_t>(mesh);
        const Transform to_world = n.transform.start();
        if (scales[m] == 0) {
            bounds[m] = bounds_of(document, mesh);
            scales[m] = scale_of(to_world);
        }
        if (bounds[m].empty()) continue;
        for (int corner = 0; corner < 8; ++corner)
            all.extend(to_world.point({corner & 1 ? bounds[m].hi.x : bounds[m].lo.x,
                                       corner & 2 ? bounds[m].hi.y : bounds[m].lo.y,
                                       corner & 4 ? bounds[m].hi.z : bounds[m].lo.z}));
    }
    constexpr float kShare = 1e-3f;
    // A single point is as large as if it stood in a box of one unit.
    const float diagonal = all.empty() ? 0 : 2 * all.radius();
    const float radius = 0.5f * kShare * (diagonal > 0 && std::isfinite(diagonal) ? diagonal : 1);
    std::vector<float> radii(meshes.size(), radius);
    for (size_t m = 0; m < radii.size(); ++m)
        if (scales[m] > 0 && std::isfinite(radius / scales[m])) radii[m] = radius / scales[m];
    return radii;
}

std::vector<uint32_t> make_solid(TriangleMesh& mesh, const std::vector<uint32_t>& indices, int mode,
                                 float radius) {
    Solids solids;
    const auto line = [&](uint32_t i, uint32_t k) {
        solids.add_line(i, k, mesh.positions[k] - mesh.positions[i], radius);
    };
    const size_t count = indices.size();
    if (mode == TINYGLTF_MODE_POINTS)
        for (const uint32_t i : indices) solids.add_point(i, radius);
    else if (mode == TINYGLTF_MODE_LINE)
        for (size_t k = 0; k + 1 < count; k += 2) line(indices[k], indices[k + 1]);
    else
        for (size_t k = 0; k + 1 < count; ++k) line(indices[k], indices[k + 1]);
    if (mode == TINYGLTF_MODE_LINE_LOOP && count > 2) line(indices[count - 1], indices[0]);
    pick_vertices(mesh, solids.sources);
    for (size_t i = 0; i < solids.offsets.size(); ++i) mesh.positions[i] += solids.offsets[i];
    mesh.triangles = std::move(solids.triangles);
    return std::move(solids.sources);
}

}  // namespace covtrace::gltf
