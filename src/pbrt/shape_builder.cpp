#include "pbrt/shape_builder.h"

#include <algorithm>

#include "pbrt/loop_subdivision.h"
#include "pbrt/round_meshes.h"
#include "pbrt/version_three.h"
#include "scene/names.h"

namespace covtrace {

namespace {

float sweep(Entity& e) {
    const float phi = e.parameters.number("phimax", 360);
    if (!(phi > 0)) e.refuse("phimax", "parameter \"phimax\" must be greater than 0");
    return std::min(phi, 360.0f);
}

Sphere sphere(Entity& e) {
    Sphere s;
    s.radius = e.positive("radius", 1);
    const float z0 = e.parameters.number("zmin", -s.radius),
                z1 = e.parameters.number("zmax", s.radius);
    s.z_min = std::clamp(std::min(z0, z1), -s.radius, s.radius);
    s.z_max = std::clamp(std::max(z0, z1), -s.radius, s.radius);
    if (!(s.z_min < s.z_max)) e.refuse("zmin", "\"zmin\" and \"zmax\" leave nothing of the sphere");
    s.phi_max = sweep(e);
    return s;
}

Disk disk(Entity& e) {
    Disk d;
    d.height = e.parameters.number("height", 0);
    d.radius = e.positive("radius", 1);
    d.inner_radius = e.parameters.number("innerradius", 0);
    if (!(d.inner_radius >= 0 && d.inner_radius < d.radius))
        e.refuse("innerradius", "parameter \"innerradius\" must be from 0 to less than the radius");
    d.phi_max = sweep(e);
    return d;
}

/// Corners of N-sided faces, checked against the number of positions.
template <size_t N>
std::vector<std::array<uint32_t, N>> faces(Entity& e, size_t positions, WarningLog& log) {
    std::vector<int> indices = e.parameters.integers("indices");
    if (indices.empty()) {
        if (positions != N)
            throw Error(
                ErrorKind::scene, e.where,
                "shape " + in_quotes(e.type) + " has no faces; expected \"integer indices\"");
        for (size_t i = 0; i < N; ++i) indices.push_back(static_cast<int>(i));
    }
    if (indices.size() % N != 0)
        log.add(e.parameters.where("indices", e.where),
                "the number of indices is not a multiple of " + std::to_string(N) +
                    "; the rest is ignored");
    std::vector<std::array<uint32_t, N>> all(indices.size() / N);
    for (size_t i = 0; i < all.size() * N; ++i) {
        if (indices[i] < 0 || static_cast<size_t>(indices[i]) >= positions)
            e.refuse("indices", "index " + std::to_string(indices[i]) +
                                    " is out of range; there are " + std::to_string(positions) +
                                    " positions, counted from 0");
        all[i / N][i % N] = static_cast<uint32_t>(indices[i]);
    }
    return all;
}

template <typename Vector>
void match_positions(std::vector<Vector>& values, size_t positions, const char* name,
                     const Entity& e, WarningLog& log) {
    if (values.empty() || values.size() == positions) return;
    log.add(e.parameters.where(name, e.where),
            in_quotes(name) + " has another number of values than \"P\"; ignored");
    values.clear();
}

/// Reads P, N and uv, which all meshes given inline have in common.
template <typename Mesh>
void vertices(Mesh& mesh, Entity& e, WarningLog& log) {
    mesh.positions = e.parameters.triples("P");
    if (mesh.positions.empty())
        throw Error(ErrorKind::scene, e.where,
                    "shape " + in_quotes(e.type) + " has no vertices; expected \"point3 P\"");
    mesh.normals = e.parameters.triples("N");
    mesh.uvs = e.parameters.pairs("uv");
    match_positions(mesh.normals, mesh.positions.size(), "N", e, log);
    match_positions(mesh.uvs, mesh.positions.size(), "uv", e, log);
}

/// The normals of a ribbon, `count` of them, none of them zero.
std::vector<Vec3> ribbon_normals(Entity& e, size_t count) {
    std::vector<Vec3> normals = e.parameters.triples("N");
    if (normals.size() != count)
        e.refuse("N", "a ribbon of " + std::to_string(count - 1) + " segments has " +
                          std::to_string(normals.size()) + " normals; expected \"normal N\" with " +
                          std::to_string(count) + ", of both ends of each segment");
    for (const Vec3& n : normals)
        if (!(length(n) > 0)) e.refuse("N", "a normal of a ribbon must not be zero");
    return normals;
}

}  // namespace

std::vector<ShapeGeometry> ShapeBuilder::triangle_mesh(Entity& e) {
    TriangleMesh mesh;
    vertices(mesh, e, context_.log);
    mesh.triangles = faces<3>(e, mesh.positions.size(), context_.log);
    mesh.tangents = e.parameters.triples("S");
    match_positions(mesh.tangents, mesh.positions.size(), "S", e, context_.log);
    e.parameters.ignore({"faceIndices"});
    return {std::make_shared<const TriangleMesh>(std::move(mesh))};
}

std::vector<ShapeGeometry> ShapeBuilder::bilinear_mesh(Entity& e) {
    BilinearMesh mesh;
    vertices(mesh, e, context_.log);
    mesh.patches = faces<4>(e, mesh.positions.size(), context_.log);
    // The parameter emissionfilename is, in pbrt, an image of where samples of the light should go;
    // its radiance is the light's own.
    e.parameters.ignore({"emissionfilename", "faceIndices"});
    return {std::make_shared<const BilinearMesh>(std::move(mesh))};
}

size_t ShapeBuilder::mesh_file(Entity& e) {
    const std::string name = e.parameters.text("filename");
    const SourceLocation where = e.parameters.where("filename", e.where);
    if (name.empty())
        throw Error(ErrorKind::scene, where, "a plymesh has no file; expected \"string filename\"");
    return mesh_files_.add(context_.files.find(name, where), where, e.directive);
}

std::vector<ShapeGeometry> ShapeBuilder::mesh(size_t file, bool as_triangles) const {
    const PlyMesh& mesh = mesh_files_[file];
    if (as_triangles && mesh.quads) return {triangles_of(mesh)};
    std::vector<ShapeGeometry> shapes;
    if (mesh.triangles) shapes.emplace_back(mesh.triangles);
    if (mesh.quads) shapes.emplace_back(mesh.quads);
    return shapes;
}

std::vector<ShapeGeometry> ShapeBuilder::subdivided_mesh(Entity& e) {
    constexpr int most_levels = 10;
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
    constexpr size_t most_triangles = size_t{1} << 16;  // refining more is what would be found
#else
    constexpr size_t most_triangles = size_t{1} << 26;
#endif
    TriangleMesh control;
    vertices(control, e, context_.log);
    control.triangles = faces<3>(e, control.positions.size(), context_.log);
    e.parameters.ignore({"N", "uv", "scheme"});
    const int levels = e.parameters.integer("levels", 3);
    if (levels < 0 || levels > most_levels)
        e.refuse("levels", "parameter \"levels\" must be from 0 to " + std::to_string(most_levels));
    if ((control.triangles.size() << (2 * levels)) > most_triangles)
        throw Error(ErrorKind::limit, e.where,
                    "the subdivision makes more than 2^26 triangles; expected fewer levels");
    if (control.triangles.empty()) return {};
    return {std::make_shared<const TriangleMesh>(
        loop_subdivide(control.positions, control.triangles, levels, e.where))};
}

std::vector<ShapeGeometry> ShapeBuilder::cylinder(Entity& e) {
    const float radius = e.positive("radius", 1);
    const float z0 = e.parameters.number("zmin", -1), z1 = e.parameters.number("zmax", 1);
    if (z0 == z1) e.refuse("zmin", "\"zmin\" and \"zmax\" leave nothing of the cylinder");
    context_.log.add(e.where, "shape \"cylinder\" is rendered as a mesh of 256 triangles");
    return {std::make_shared<const TriangleMesh>(
        cylinder_mesh(radius, std::min(z0, z1), std::max(z0, z1), sweep(e), 128))};
}

BuiltShape ShapeBuilder::curve(Entity& e) {
    ParameterList& p = e.parameters;
    CurveDescription c;
    const float width = p.number("width", 1);
    c.width0 = p.number("width0", width);
    c.width1 = p.number("width1", width);
    c.degree = p.integer("degree", 3);
    if (c.degree != 2 && c.degree != 3) e.refuse("degree", "parameter \"degree\" must be 2 or 3");
    const std::string basis = p.text("basis", "bezier");
    if (basis != "bezier" && basis != "bspline")
        e.refuse("basis", unknown_name("curve basis", basis, {"bezier", "bspline"}));
    c.is_bspline = basis == "bspline";
    const std::string type = p.text("type", "flat");
    if (type != "flat" && type != "ribbon" && type != "cylinder")
        e.refuse("type", unknown_name("curve type", type, {"flat", "ribbon", "cylinder"}));
    c.points = p.triples("P");
    const auto degree = static_cast<size_t>(c.degree);
    if (c.points.size() < degree + 1 || (!c.is_bspline && (c.points.size() - 1) % degree != 0))
        e.refuse("P", std::to_string(c.points.size()) +
                          " control points don't make a curve of degree " + std::to_string(degree));
    p.ignore({"splitdepth"});
    BuiltShape built;
    if (type == "ribbon") {
        c.normals = ribbon_normals(e, c.segments() + 1);
        built.geometry = {std::make_shared<const TriangleMesh>(ribbon_mesh(c))};
        return built;
    }
    p.ignore({"N"});
    context_.log.add(e.where, "shape \"curve\" is rendered as a thin tube");
    built.geometry = {std::make_shared<const TriangleMesh>(curve_mesh(c))};
    built.tube_sides = sides_of(c);
    return built;
}

int ShapeBuilder::tube_sides(Entity& e) {
    const int sides = e.parameters.integer("tubesides", 0);
    if (sides != 0 && sides < 3)
        e.refuse("tubesides", "parameter \"tubesides\" is " + std::to_string(sides) +
                                  "; expected 3 or more sides, or 0 where there are no tubes");
    return sides;
}

BuiltShape ShapeBuilder::build(Entity& e) {
    BuiltShape built;
    std::vector<ShapeGeometry>& shapes = built.geometry;
    if (e.type == "plymesh") {
        built.mesh_file = mesh_file(e);
        built.tube_sides = tube_sides(e);
    } else if (e.type == "trianglemesh") {
        shapes = triangle_mesh(e);
        built.tube_sides = tube_sides(e);
    } else if (e.type == "sphere") {
        shapes = {sphere(e)};
    } else if (e.type == "disk") {
        shapes = {disk(e)};
    } else if (e.type == "bilinearmesh") {
        shapes = bilinear_mesh(e);
    } else if (e.type == "loopsubdiv") {
        shapes = subdivided_mesh(e);
    } else if (e.type == "cylinder") {
        shapes = cylinder(e);
    } else if (e.type == "curve") {
        built = curve(e);
    } else {
        throw unknown_type_error(e.where, "shape", e.type,
                                 {"trianglemesh", "plymesh", "sphere", "disk", "bilinearmesh",
                                  "loopsubdiv", "cylinder", "curve"});
    }
    e.parameters.ignore({"alpha"});
    e.parameters.warn_unused(context_.log, "shape " + in_quotes(e.type));
    return built;
}

}  // namespace covtrace
