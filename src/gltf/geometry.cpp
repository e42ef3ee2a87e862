#include "gltf/geometry.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "gltf/accessor.h"
#include "gltf/marks.h"
#include "gltf/tangents.h"
#include "gltf/vertex_pick.h"
#include "scene/vertex_colours.h"

namespace covtrace::gltf {
namespace {

/// Most vertices of one primitive: they are counted in 32 bits, with room to spare.
constexpr size_t kMostVertices = size_t{1} << 30;

std::vector<std::array<uint32_t, 3>> triangles(const std::vector<uint32_t>& i, int mode) {
    std::vector<std::array<uint32_t, 3>> result;
    if (i.size() < 3) return result;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        result.reserve(i.size() / 3);
        for (size_t k = 0; k + 2 < i.size(); k += 3) result.push_back({i[k], i[k + 1], i[k + 2]});
        return result;
    }
    result.reserve(i.size() - 2);
    for (size_t k = 0; k + 2 < i.size(); ++k) {
        const std::array<uint32_t, 3> t =
            mode == TINYGLTF_MODE_TRIANGLE_FAN
                ? std::array{i[k + 1], i[k + 2], i[0]}
                : std::array{i[k], i[k + 1 + k % 2], i[k + 2 - k % 2]};
        // Triangles without area are left out: they only join strips.
        if (t[0] != t[1] && t[1] != t[2] && t[0] != t[2]) result.push_back(t);
    }
    return result;
}

/// Leaves out the vertices that no triangle uses, where these are the most: files hold primitives
/// that pick their triangles from the vertices of a whole model. Returns the indices of the
/// vertices that are kept, in order; empty where all are.
std::vector<uint32_t> keep_used_vertices(TriangleMesh& mesh) {
    constexpr uint32_t kUnused = ~uint32_t{0};
    std::vector<uint32_t> place(mesh.positions.size(), kUnused);
    std::vector<uint32_t> used;
    for (const auto& triangle : mesh.triangles)
        for (const uint32_t i : triangle) {
            if (place[i] != kUnused) continue;
            place[i] = static_cast<uint32_t>(used.size());
            used.push_back(i);
        }
    if (used.size() > mesh.positions.size() / 2) return {};
    pick_vertices(mesh, used);
    for (auto& triangle : mesh.triangles)
        for (uint32_t& i : triangle) i = place[i];
    return used;
}

std::vector<Vec3> vectors(const Numbers& n) {
    std::vector<Vec3> v(n.count());
    for (size_t i = 0; i < v.size(); ++i)
        v[i] = {n.element(i)[0], n.element(i)[1], n.element(i)[2]};
    return v;
}

/// Indices of the vertices that were made of one of `sources`, sorted; `made_of`: by vertex.
std::vector<uint32_t> vertices_of(const std::vector<uint32_t>& made_of,
                                  const std::vector<uint32_t>& sources) {
    std::vector<uint32_t> vertices;
    for (size_t i = 0; i < made_of.size(); ++i)
        if (std::binary_search(sources.begin(), sources.end(), made_of[i]))
            vertices.push_back(static_cast<uint32_t>(i));
    return vertices;
}

/// Gives vertices the mean normal of the triangles around them, by area.
void take_normals_of_triangles(TriangleMesh& mesh, const std::vector<uint32_t>& vertices) {
    if (vertices.empty()) return;
    std::vector<Vec3> sums(mesh.positions.size());
    for (const auto& t : mesh.triangles) {
        const Vec3& corner = mesh.positions[t[0]];
        const Vec3 normal = cross(mesh.positions[t[1]] - corner, mesh.positions[t[2]] - corner);
        for (const uint32_t i : t) sums[i] += normal;
    }
    for (const uint32_t i : vertices) {
        const float size = length(sums[i]);
        mesh.normals[i] = size > 0 && std::isfinite(size) ? sums[i] / size : Vec3{0, 0, 1};
    }
}

std::string place_of(int mesh, size_t primitive) {
    return element("meshes", static_cast<size_t>(mesh)) + "." + element("primitives", primitive);
}

}  // namespace

std::shared_ptr<const TriangleMesh> GeometryReader::mesh(int mesh, size_t primitive,
                                                         const VertexLayout& layout) {
    return entry(mesh, primitive, layout).mesh;
}

GeometryReader::Entry& GeometryReader::entry(int mesh, size_t primitive,
                                             const VertexLayout& layout) {
    const auto [it, is_new] = meshes_.try_emplace({mesh, primitive, layout});
    if (is_new)
        it->second = read(document_.model.meshes[static_cast<size_t>(mesh)].primitives[primitive],
                          layout, mark_radii_.empty() ? 0 : mark_radii_[static_cast<size_t>(mesh)],
                          place_of(mesh, primitive));
    return it->second;
}

const Deformation& GeometryReader::deformation(int mesh, size_t primitive,
                                               const VertexLayout& layout) {
    Entry& e = entry(mesh, primitive, layout);
    if (!e.deformation)
        e.deformation = read_deformation(
            document_, document_.model.meshes[static_cast<size_t>(mesh)].primitives[primitive],
            e.count, e.kept, place_of(mesh, primitive));
    return *e.deformation;
}

bool GeometryReader::has_joints(int mesh, size_t primitive, const VertexLayout& layout) {
    return deformation(mesh, primitive, layout).influences > 0;
}

TriangleMesh GeometryReader::deformed(int mesh, size_t primitive, const VertexLayout& layout,
                                      std::span<const double> weights,
                                      std::span<const Matrix4> joints, const std::string& place) {
    const Deformation& d = deformation(mesh, primitive, layout);
    const TriangleMesh& rest = *entry(mesh, primitive, layout).mesh;
    // The budget counts targets and joints as vertices, so that it bounds the time, too.
    const auto moving = static_cast<size_t>(
        std::count_if(weights.begin(), weights.end(), [](double w) { return w != 0; }));
    spend(rest, rest.positions.size() * (1 + moving + d.influences), place);
    return deform(document_, rest, d, weights, joints, place);
}

void GeometryReader::spend(const TriangleMesh& mesh, size_t vertices, const std::string& place) {
    const size_t vertex = 2 * sizeof(Vec3) + sizeof(Vec2) * (1 + mesh.more_uvs.size()) +
                          (mesh.colours.empty() ? 0 : sizeof(VertexColour));
    constexpr size_t kTriangle = 3 * sizeof(uint32_t);
    if (!bytes_.spend(vertices, vertex) || !bytes_.spend(mesh.triangles.size(), kTriangle))
        throw Error(ErrorKind::limit, document_.place(place),
                    "it and the meshes before are too large for a file of " +
                        std::to_string(document_.bytes) + " bytes");
}

ColourUse GeometryReader::colours(int mesh, size_t primitive) {
    const tinygltf::Primitive& source =
        document_.model.meshes[static_cast<size_t>(mesh)].primitives[primitive];
    const auto colour = source.attributes.find("COLOR_0");
    if (colour == source.attributes.end()) return {};
    const auto [it, is_new] = colours_.try_emplace(colour->second);
    if (is_new)
        it->second = use_of(read_colours(document_, colour->second,
                                         place_of(mesh, primitive) + ".attributes.COLOR_0"));
    return it->second;
}

void GeometryReader::read_vertex_values(const tinygltf::Primitive& primitive,
                                        const VertexLayout& layout, TriangleMesh& mesh,
                                        const std::string& place) {
    const size_t count = mesh.positions.size();
    const std::string attributes = place + ".attributes.";
    const auto read_uvs = [&](int set, bool is_needed) {
        std::vector<Vec2> uvs;
        if (set == VertexLayout::kNoSet) return uvs;
        const std::string name = "TEXCOORD_" + std::to_string(set);
        const auto it = primitive.attributes.find(name);
        if (it == primitive.attributes.end()) {
            if (!is_needed) return uvs;
            warn(place, "has textures but no " + name + "; they are looked up at (0, 0)");
            uvs.assign(count, Vec2{0, 1});
            return uvs;
        }
        const Numbers uv = read_numbers(document_, it->second, 2, attributes + name);
        require_count(document_, uv.count(), count, attributes + name);
        uvs.resize(count);
        for (size_t i = 0; i < count; ++i) uvs[i] = {uv.element(i)[0], 1 - uv.element(i)[1]};
        return uvs;
    };
    mesh.uvs = read_uvs(layout.uv_set, layout.needs_uvs);
    for (const int set : layout.more_sets) mesh.more_uvs.push_back(read_uvs(set, true));
    if (!layout.has_colours) return;
    const std::string name = attributes + "COLOR_0";
    mesh.colours = read_colours(document_, primitive.attributes.at("COLOR_0"), name);
    require_count(document_, mesh.colours.size(), count, name);
}

GeometryReader::Entry GeometryReader::read(const tinygltf::Primitive& primitive,
                                           const VertexLayout& layout, float mark_radius,
                                           const std::string& place) {
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode > TINYGLTF_MODE_TRIANGLE_FAN)
        document_.refuse(place + ".mode",
                         std::to_string(mode) + " is no kind of primitive; expected 0 to 6");
    const auto attribute = [&](const std::string& name) {
        const auto it = primitive.attributes.find(name);
        return it == primitive.attributes.end() ? -1 : it->second;
    };
    if (!primitive.attributes.contains("POSITION")) {
        warn(place, "a primitive without positions is left out");
        return {};
    }
    const std::string attributes = place + ".attributes.";
    const size_t count = accessor_count(document_, attribute("POSITION"), attributes + "POSITION");
    if (count > kMostVertices)
        throw Error(ErrorKind::limit, document_.place(place), "it has more than 2^30 vertices");
    const auto read_attribute = [&](const std::string& name, size_t components) {
        const auto not_finite = name == "NORMAL" ? NotFinite::zero : NotFinite::refused;
        Numbers n =
            read_numbers(document_, attribute(name), components, attributes + name, not_finite);
        require_count(document_, n.count(), count, attributes + name);
        return n;
    };

    auto mesh = std::make_shared<TriangleMesh>();
    mesh->positions = vectors(read_attribute("POSITION", 3));
    std::vector<uint32_t> without_normal;
    if (attribute("NORMAL") >= 0) {
        const Numbers normals = read_attribute("NORMAL", 3);
        mesh->normals = vectors(normals);
        without_normal = normals.not_finite;
    }
    read_vertex_values(primitive, layout, *mesh, place);

    std::vector<uint32_t> indices;
    if (primitive.indices >= 0) {
        indices = read_indices(document_, primitive.indices, count, place + ".indices");
    } else {
        indices.resize(count);
        std::iota(indices.begin(), indices.end(), 0);
    }
    Entry result;
    result.count = count;
    if (!without_normal.empty())
        warn(attributes + "NORMAL",
             "normals that are not finite become the mean of the triangles around them");
    if (has_marks(primitive)) {
        result.kept = make_solid(*mesh, indices, mode, mark_radius);
        without_normal = vertices_of(result.kept, without_normal);
    } else {
        mesh->triangles = triangles(indices, mode);
    }
    take_normals_of_triangles(*mesh, without_normal);
    if (mesh->triangles.empty()) return {};
    // By the specification tangents count beside normals only.
    if (layout.needs_tangents && attribute("TANGENT") >= 0 && !mesh->normals.empty() &&
        !has_marks(primitive))
        read_tangents(document_, attribute("TANGENT"), *mesh, attributes + "TANGENT");
    if (!has_marks(primitive)) result.kept = keep_used_vertices(*mesh);
    spend(*mesh, mesh->positions.size(), place);
    if (!mesh->colours.empty()) find_colour_steps(*mesh);
    result.mesh = std::move(mesh);
    return result;
}

}  // namespace covtrace::gltf
