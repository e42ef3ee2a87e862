#include <cmath>

#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

const TriangleMesh& mesh_of(const SceneDescription& scene, size_t shape = 0) {
    return *std::get<std::shared_ptr<const TriangleMesh>>(scene.shapes.at(shape).geometry);
}

TEST(SceneShapes, TriangleMeshesKeepTheirData) {
    const auto scene = read_world(
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 1 1 0 ] \"integer indices\" [ 0 1 "
        "2 1 3 2 ]\n"
        "\"point2 uv\" [ 0 0 1 0 0 1 1 1 ] \"normal N\" [ 0 0 1 0 0 1 0 0 1 0 0 1 ] \"vector3 S\" "
        "[ 1 0 0 1 0 0 1 0 0 0 2 0 ]");
    const TriangleMesh& m = mesh_of(scene);
    EXPECT_EQ(m.positions.size(), 4u);
    EXPECT_EQ(m.positions[3], (Vec3{1, 1, 0}));
    EXPECT_EQ(m.triangles, (std::vector<std::array<uint32_t, 3>>{{0, 1, 2}, {1, 3, 2}}));
    EXPECT_EQ(m.normals.size(), 4u);
    EXPECT_EQ(m.uvs.size(), 4u);
    ASSERT_EQ(m.tangents.size(), 4u);
    EXPECT_EQ(m.tangents[3], (Vec3{0, 2, 0}));
    EXPECT_EQ(warnings_of(scene), "");
}

TEST(SceneShapes, TangentsOfAnotherNumberThanThePositionsAreIgnored) {
    const auto scene = read_world(
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"vector3 S\" [ 1 0 0 ]");
    EXPECT_TRUE(mesh_of(scene).tangents.empty());
    ASSERT_EQ(scene.warnings.size(), 1u) << warnings_of(scene);
    EXPECT_NE(scene.warnings[0].text.find("\"S\""), std::string::npos);
}

TEST(SceneShapes, OneTriangleNeedsNoIndices) {
    const auto scene = read_world(
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 1 1 0 ]");
    EXPECT_EQ(mesh_of(scene).triangles.size(), 1u);
    const auto& b = *std::get<std::shared_ptr<const BilinearMesh>>(scene.shapes.at(1).geometry);
    EXPECT_EQ(b.patches, (std::vector<std::array<uint32_t, 4>>{{0, 1, 2, 3}}));
}

TEST(SceneShapes, WrongCountsAreDroppedWithAWarning) {
    const auto scene = read_world(
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"integer indices\" [ 0 1 2 0 "
        "]\n"
        "\"point2 uv\" [ 0 0 ] \"normal N\" [ 0 0 1 ]");
    EXPECT_EQ(mesh_of(scene).triangles.size(), 1u);
    EXPECT_TRUE(mesh_of(scene).uvs.empty());
    EXPECT_TRUE(mesh_of(scene).normals.empty());
    EXPECT_EQ(scene.warnings.size(), 3u) << warnings_of(scene);
}

TEST(SceneShapes, WhatOneDirectiveMadeIsKnownAsSuch) {
    const TemporaryFolder folder;
    folder.write("m.ply",
                 "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
                 "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 0\n4 0 1 2 3\n3 1 4 2\n");
    const auto scene = read_pbrt(
        folder.write("scene.pbrt",
                     "WorldBegin AreaLightSource \"diffuse\" \"float power\" 10\n"
                     "Shape \"plymesh\" \"string filename\" \"m.ply\"\nShape \"sphere\""));
    ASSERT_EQ(scene.shapes.size(), 3u);
    EXPECT_GE(scene.shapes[0].directive, 0);
    EXPECT_EQ(scene.shapes[0].directive, scene.shapes[1].directive);
    EXPECT_NE(scene.shapes[0].directive, scene.shapes[2].directive);
}

TEST(SceneShapes, QuadricsHaveTheirDefaults) {
    const auto scene = read_world(
        "Shape \"sphere\" Shape \"sphere\" \"float radius\" 2 \"float zmin\" 1 \"float zmax\" -9 "
        "\"float phimax\" 400\n"
        "Shape \"disk\" Shape \"disk\" \"float height\" 1 \"float radius\" 3 \"float innerradius\" "
        "2 \"float phimax\" 90");
    const auto& s = std::get<Sphere>(scene.shapes.at(0).geometry);
    EXPECT_EQ(s.radius, 1);
    EXPECT_EQ(s.z_min, -1);
    EXPECT_EQ(s.z_max, 1);
    EXPECT_EQ(s.phi_max, 360);
    const auto& t = std::get<Sphere>(scene.shapes.at(1).geometry);
    EXPECT_EQ(t.z_min, -2);
    EXPECT_EQ(t.z_max, 1);
    EXPECT_EQ(t.phi_max, 360);
    const auto& d = std::get<Disk>(scene.shapes.at(3).geometry);
    EXPECT_EQ(d.height, 1);
    EXPECT_EQ(d.inner_radius, 2);
    EXPECT_EQ(d.phi_max, 90);
}

TEST(SceneShapes, AlphaIsKeptWhereItMatters) {
    const auto scene = read_world(
        "Texture \"leaf\" \"float\" \"constant\" \"float value\" .5\n"
        "Shape \"sphere\" \"texture alpha\" \"leaf\"\nShape \"sphere\" \"float alpha\" .25\n"
        "Shape \"sphere\" \"float alpha\" 1\nShape \"disk\" \"float alpha\" 0\n"
        "AreaLightSource \"diffuse\" Shape \"disk\" \"float alpha\" 0\n");
    ASSERT_EQ(scene.shapes.size(), 4u);  // a shape that is neither seen nor emits is left out
    EXPECT_EQ(constant_value(scene, scene.shapes[0].alpha), Rgb{0.5f});
    EXPECT_EQ(constant_value(scene, scene.shapes[1].alpha), Rgb{0.25f});
    EXPECT_EQ(scene.shapes[2].alpha, -1);
    EXPECT_EQ(scene.shapes[3].area_light, 0);
    EXPECT_EQ(constant_value(scene, scene.shapes[3].alpha), Rgb{0});
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

TEST(SceneShapes, CylindersBecomeMeshesOfTheirArea) {
    const auto scene = read_world(
        "Shape \"cylinder\" \"float radius\" 2 \"float zmin\" -1 \"float zmax\" 3 \"float phimax\" "
        "180");
    const TriangleMesh& m = mesh_of(scene);
    double area = 0;
    for (const auto& t : m.triangles) {
        const Vec3 n =
            cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]);
        area += 0.5 * length(n);
        EXPECT_GT(dot(n, m.normals[t[0]]), 0);
    }
    EXPECT_NEAR(area, kPi * 2 * 4, 0.01);
    EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(SceneShapes, CurvesBecomeTubesAroundThem) {
    // A straight line has the same shape in every basis.
    for (const char* basis : {"\"string basis\" \"bezier\"", "\"string basis\" \"bspline\"",
                              "\"integer degree\" 2 \"point3 P\" [ 0 0 0  0 0 1  0 0 2 ]"}) {
        const auto scene = read_world(
            std::string(
                "Shape \"curve\" \"point3 P\" [ 0 0 0  0 0 1  0 0 2  0 0 3 ] \"float width\" .2 ") +
            basis);
        const TriangleMesh& m = mesh_of(scene);
        for (const Vec3& p : m.positions) {
            EXPECT_NEAR(std::hypot(p.x, p.y), std::hypot(m.positions[0].x, m.positions[0].y),
                        1e-5f);
            EXPECT_GE(p.z, -1e-5f);
            EXPECT_LE(p.z, 3 + 1e-5f);
        }
        ASSERT_EQ(m.normals.size(), m.positions.size());
        EXPECT_EQ(scene.shapes.front().tube_sides, 24) << "light is scattered by it once";
        // The mean width over all sides, around the first ring, is the circumference over pi.
        float around = 0;
        size_t sides = 0;
        for (; m.positions[sides + 1].z < m.positions[0].z + 1e-5f; ++sides)
            around += distance(m.positions[sides], m.positions[sides + 1]);
        EXPECT_NEAR(around, kPi * 0.2f, 1e-5f);
        // Smooth normals over n sides lose 1.6 / n^2 of the light at each bounce.
        EXPECT_LT(1.6 / double(sides * sides), 0.003);
        for (const auto& t : m.triangles)
            EXPECT_GT(dot(cross(m.positions[t[1]] - m.positions[t[0]],
                                m.positions[t[2]] - m.positions[t[0]]),
                          m.normals[t[0]]),
                      0);
    }
    // A uniform cubic B-spline starts at (p0 + 4 p1 + p2) / 6.
    const auto scene = read_world(
        "Shape \"curve\" \"string basis\" \"bspline\" \"point3 P\" [ 0 0 0  6 0 0  0 6 0  0 0 6 ] "
        "\"float width\" 0");
    expect_near(mesh_of(scene).positions.front(), {4, 1, 0}, 1e-5f);
    expect_near(mesh_of(scene).positions.back(), {1, 4, 1}, 1e-5f);
}

TEST(SceneShapes, MeshesMayBeTubes) {
    const std::string triangle =
        "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ] \"integer tubesides\" ";
    EXPECT_EQ(read_world(triangle + "6").shapes.front().tube_sides, 6);
    EXPECT_EQ(read_world(triangle + "0").shapes.front().tube_sides, 0);
    EXPECT_THROW(read_world(triangle + "2"), Error);
    EXPECT_THROW(read_world(triangle + "-3"), Error);
}

TEST(SceneShapes, SlenderCurvesAreTurnedPrisms) {
    // Smooth normals over flat sides would lose light; the prisms' turns make up for their sides.
    const auto scene = read_world(
        "Shape \"curve\" \"point3 P\" [ 0 0 0  0 0 1  0 0 2  0 0 3 ] \"float width\" .02\n"
        "Shape \"curve\" \"point3 P\" [ 0 0 0  0 0 1  0 0 2  0 0 3.1 ] \"float width\" .02");
    float angles[2];
    for (size_t shape : {0, 1}) {
        const TriangleMesh& m = mesh_of(scene, shape);
        EXPECT_TRUE(m.normals.empty());
        EXPECT_EQ(scene.shapes.at(shape).tube_sides, 5);
        const Vec3 corner = m.positions[0];
        angles[shape] = std::atan2(corner.y, corner.x);
        for (const auto& t : m.triangles) {
            const Vec3 middle = (m.positions[t[0]] + m.positions[t[1]] + m.positions[t[2]]) / 3;
            EXPECT_GT(dot(cross(m.positions[t[1]] - m.positions[t[0]],
                                m.positions[t[2]] - m.positions[t[0]]),
                          Vec3{middle.x, middle.y, 0}),
                      0);
        }
    }
    EXPECT_GT(std::abs(angles[0] - angles[1]), 0.01f);
}

TEST(SceneShapes, RibbonsFaceTheirNormals) {
    const std::string ribbon =
        "Shape \"curve\" \"string type\" \"ribbon\" \"float width\" .2 "
        "\"point3 P\" [ 0 0 0  0 1 0  0 2 0  0 3 0  0 4 0  0 5 0  0 6 0 ] ";
    const auto scene = read_world(ribbon + "\"normal N\" [ 0 0 2  3 0 0  3 5 0 ]");
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
    EXPECT_EQ(scene.shapes.front().tube_sides, 0);
    const TriangleMesh& m = mesh_of(scene);
    ASSERT_EQ(m.normals.size(), m.positions.size());
    expect_near(m.positions[0], {-0.1f, 0, 0}, 1e-6f);
    expect_near(m.positions[1], {0.1f, 0, 0}, 1e-6f);
    EXPECT_EQ(m.uvs[0].y, 0);
    EXPECT_EQ(m.uvs[1].y, 1);
    for (size_t i = 0; i < m.positions.size(); i += 2) {
        EXPECT_NEAR(distance(m.positions[i], m.positions[i + 1]), 0.2f, 1e-6f);
        EXPECT_NEAR(m.uvs[i].x, m.positions[i].y / 6, 1e-6f);
        // The first segment turns by a right angle, evenly; what leans along the curve changes
        // nothing.
        const float angle = kPi / 2 * std::min(1.0f, m.positions[i].y / 3);
        expect_near(m.normals[i], {std::sin(angle), 0, std::cos(angle)}, 1e-5f);
    }
    for (const auto& t : m.triangles)
        EXPECT_GT(
            dot(cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]),
                m.normals[t[0]]),
            0);
    for (const char* normals : {"", "\"normal N\" [ 0 0 1 ]", "\"normal N\" [ 0 0 1 0 0 1 0 0 0 ]"})
        EXPECT_TRUE(contains(world_error(ribbon + normals), "normal")) << normals;
}

TEST(SceneShapes, MeshFilesAreReadOnceAndShared) {
    const TemporaryFolder folder;
    folder.write("m.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
                 "y\nproperty float z\n"
                 "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 "
                 "0\n0 1 0\n3 0 1 2\n");
    const auto main = folder.write("main.pbrt",
                                   "WorldBegin Shape \"plymesh\" \"string filename\" \"m.ply\"\n"
                                   "Shape \"plymesh\" \"string filename\" [ \"m.ply\" ]");
    const auto scene = read_pbrt(main);
    EXPECT_EQ(&mesh_of(scene, 0), &mesh_of(scene, 1));
}

TEST(SceneShapes, DisplacedMeshesAreTrianglesWithTheirHeights) {
    const TemporaryFolder folder;
    const auto ply = [&](const char* uv, const char* rows) {
        folder.write("m.ply",
                     std::string("ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\n"
                                 "property float y\nproperty float z\n") +
                         uv +
                         "element face 2\nproperty list uchar int vertex_indices\n"
                         "end_header\n" +
                         rows + "4 0 1 2 3\n3 1 4 2\n");
    };
    const auto read = [&](const std::string& options, const std::string& parameters) {
        return read_pbrt(folder.write("scene.pbrt", options + R"(WorldBegin
LightSource "infinite"
Texture "height" "float" "checkerboard"
Shape "plymesh" "string filename" "m.ply" )" + parameters));
    };
    const char* rows = "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n2 0 0 0 0\n";
    ply("property float u\nproperty float v\n", rows);
    const std::string displaced = "\"texture displacement\" \"height\" \"float edgelength\" 0.5";
    const auto scene = read("", displaced);
    EXPECT_EQ(warnings_of(scene), "");
    ASSERT_EQ(scene.shapes.size(), 1u) << "quads and triangles are one mesh";
    EXPECT_EQ(mesh_of(scene).triangles,
              (std::vector<std::array<uint32_t, 3>>{{1, 4, 2}, {0, 1, 2}, {0, 2, 3}}));
    ASSERT_TRUE(scene.shapes[0].displacement);
    EXPECT_EQ(scene.shapes[0].displacement->edge_length, 0.5f);
    EXPECT_TRUE(std::holds_alternative<CheckerboardTexture>(
        scene.textures.at(size_t(scene.shapes[0].displacement->height)).value));
    EXPECT_EQ(
        read("Option \"displacementedgescale\" 3\n", displaced).shapes[0].displacement->edge_length,
        1.5f);
    EXPECT_FALSE(read("", "\"float edgelength\" 2").shapes[0].displacement);
    const auto error = [&](const std::string& options, const std::string& parameters) {
        return failure_of([&] { read(options, parameters); }).message;
    };
    EXPECT_TRUE(contains(error("", "\"texture displacement\" \"height\" \"float edgelength\" 0"),
                         "edgelength"));
    EXPECT_TRUE(contains(error("Option \"displacementedgescale\" 0\n", displaced),
                         "displacementedgescale"));
    ply("property float a\nproperty float b\n", rows);
    EXPECT_TRUE(contains(error("", displaced), "expected one whose vertices have u and v"));
}

TEST(SceneShapes, ErrorsNameThePlace) {
    struct Case {
        const char* text;
        const char* message;
    };
    const Case cases[] = {
        {"Shape \"teapot\"",
         "test.pbrt:2:1: unknown shape \"teapot\"; expected one of trianglemesh, plymesh"},
        {"Shape \"spere\"", "did you mean \"sphere\"?"},
        {"Shape \"cone\"", "pbrt-v3"},
        {"Shape \"trianglemesh\"", "has no vertices"},
        {"Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 ]", "has no faces"},
        {"Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 ]", "expected a multiple of 3"},
        {"Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [ 0 1 3 ]",
         "index 3 is out of range; there are 3 positions"},
        {"Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [ 0 1 -1 ]",
         "index -1 is out of range"},
        {"Shape \"sphere\" \"float radius\" 0", "must be greater than 0"},
        {"Shape \"sphere\" \"float zmin\" 2", "leave nothing of the sphere"},
        {"Shape \"disk\" \"float innerradius\" 1", "less than the radius"},
        {"Shape \"plymesh\"", "has no file"},
        {"Shape \"plymesh\" \"string filename\" \"no.ply\"",
         "test.pbrt:2:17: file \"no.ply\" not found"},
        {"Shape \"loopsubdiv\" \"integer levels\" 11 \"point3 P\" [0 0 0 1 0 0 0 1 0]",
         "from 0 to 10"},
        {"Shape \"curve\" \"point3 P\" [ 0 0 0 1 0 0 ]", "2 control points don't make a curve"},
        {"Shape \"curve\" \"point3 P\" [0 0 0 1 1 1 2 2 2 3 3 3] \"string basis\" \"hermite\"",
         "unknown curve basis"},
    };
    for (const Case& c : cases) EXPECT_TRUE(contains(world_error(c.text), c.message)) << c.text;
}

}  // namespace
}  // namespace covtrace::test
