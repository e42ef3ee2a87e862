#include "pbrt/loop_subdivision.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

const std::vector<Vec3> kTetrahedron{{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
const Triangles kTetrahedronFaces{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
const std::vector<Vec3> kCube{{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                              {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
const Triangles kCubeFaces{{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                           {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

/// Asserts that each edge is there twice, once in each direction.
void expect_closed(const TriangleMesh& m) {
    std::map<std::pair<uint32_t, uint32_t>, int> count;
    for (const auto& t : m.triangles)
        for (size_t i = 0; i < 3; ++i) ++count[{t[i], t[(i + 1) % 3]}];
    for (const auto& [edge, n] : count) {
        EXPECT_EQ(n, 1);
        EXPECT_TRUE(count.contains({edge.second, edge.first}));
    }
}

TEST(SceneLoopSubdivision, RefinesByFourAndStaysClosed) {
    for (int levels = 0; levels <= 3; ++levels) {
        const auto m = loop_subdivide(kTetrahedron, kTetrahedronFaces, levels, {});
        EXPECT_EQ(m.triangles.size(), 4u << (2 * levels));
        // Euler's formula is V - E + F = 2 with E = 3F / 2.
        EXPECT_EQ(m.positions.size(), 2 + m.triangles.size() / 2);
        expect_closed(m);
    }
}

TEST(SceneLoopSubdivision, LimitPointsDoNotDependOnTheLevel) {
    // The vertices of a coarse mesh keep their index and are on the same limit surface at every
    // level.
    for (const auto& [points, faces] :
         {std::pair{kTetrahedron, kTetrahedronFaces}, std::pair{kCube, kCubeFaces}}) {
        const auto coarse = loop_subdivide(points, faces, 0, {});
        const auto fine = loop_subdivide(points, faces, 4, {});
        for (size_t i = 0; i < points.size(); ++i) {
            expect_near(coarse.positions[i], fine.positions[i], 2e-6f);
            expect_near(coarse.normals[i], fine.normals[i], 2e-3f);
        }
    }
}

TEST(SceneLoopSubdivision, TheTetrahedronsLimitIsKnown) {
    // The weights at valence 3 are 1/(3 + 3/(8 * 3/16)) = 1/5 of the ring, 2/5 of the vertex; the
    // ring sums to minus the vertex.
    const auto m = loop_subdivide(kTetrahedron, kTetrahedronFaces, 2, {});
    for (size_t i = 0; i < 4; ++i) {
        expect_near(m.positions[i], 0.2f * kTetrahedron[i], 1e-6f);
        // The faces are seen counterclockwise from outside; pbrt's normals are opposite to that.
        expect_near(m.normals[i], -normalize(kTetrahedron[i]), 1e-5f);
    }
}

TEST(SceneLoopSubdivision, NormalsAreThoseOfTheSurfaceOnPbrtsSide) {
    const auto m = loop_subdivide(kCube, kCubeFaces, 5, {});
    double worst = 1;
    for (const auto& t : m.triangles) {
        const Vec3 face = normalize(
            cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]));
        for (const uint32_t v : t) worst = std::min(worst, double(dot(-face, m.normals[v])));
    }
    EXPECT_GT(worst, 0.995);
    for (const Vec3& n : m.normals) EXPECT_NEAR(length(n), 1, 1e-5f);
}

TEST(SceneLoopSubdivision, FlatSheetsStayFlatWithTheirBorder) {
    std::vector<Vec3> points;
    Triangles faces;
    for (uint32_t y = 0; y < 4; ++y)
        for (uint32_t x = 0; x < 4; ++x) points.push_back({float(x), float(y), 0});
    for (uint32_t y = 0; y < 3; ++y)
        for (uint32_t x = 0; x < 3; ++x) {
            const uint32_t i = 4 * y + x;
            faces.push_back({i, i + 1, i + 5});
            faces.push_back({i, i + 5, i + 4});
        }
    const auto m = loop_subdivide(points, faces, 3, {});
    float largest = 0;
    for (size_t i = 0; i < m.positions.size(); ++i) {
        EXPECT_NEAR(m.positions[i].z, 0, 1e-6f);
        expect_near(m.normals[i], {0, 0, -1}, 1e-4f);  // inside and on the border alike
        largest = std::max(largest, std::max(m.positions[i].x, m.positions[i].y));
    }
    // A straight border stays where it is, away from the corners.
    EXPECT_NEAR(largest, 3, 1e-5f);
}

TEST(SceneLoopSubdivision, BrokenTopologyIsSurvived) {
    // The mesh has three faces on one edge, a face turned over, a face that is a line, a point
    // without faces.
    std::vector<Vec3> points = kTetrahedron;
    points.push_back({5, 5, 5});
    points.push_back({0, 0, 9});
    const Triangles faces{{0, 1, 2}, {0, 1, 3}, {1, 0, 4}, {2, 2, 3}, {3, 3, 3}};
    const auto m = loop_subdivide(points, faces, 3, {});
    for (const Vec3& p : m.positions) EXPECT_TRUE(is_finite(p));
    for (const Vec3& n : m.normals) EXPECT_NEAR(length(n), 1, 1e-4f);
    EXPECT_EQ(m.positions[5], (Vec3{0, 0, 9}));
}

TEST(SceneLoopSubdivision, IsReadFromTheScene) {
    const auto scene = read_world(
        "Shape \"loopsubdiv\" \"integer levels\" 2 \"string scheme\" \"loop\"\n"
        "\"point3 P\" [ 1 1 1 -1 -1 1 -1 1 -1 1 -1 -1 ] \"integer indices\" [ 0 2 1 0 1 3 0 3 2 1 "
        "2 3 ]");
    const auto& m = *std::get<std::shared_ptr<const TriangleMesh>>(scene.shapes.at(0).geometry);
    EXPECT_EQ(m.triangles.size(), 64u);
    EXPECT_TRUE(scene.warnings.empty()) << warnings_of(scene);
}

}  // namespace
}  // namespace covtrace::test
