// Displaced meshes: how they are split, moved, and joined.
#include "integrator/displacement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "integrator/lit_scene.h"

namespace covtrace {
namespace {

/// A square in the plane z = 0 that faces +z, uv over it, of two triangles.
std::shared_ptr<const TriangleMesh> square(float half_side) {
    TriangleMesh m;
    const float s = half_side;
    m.positions = {{-s, -s, 0}, {s, -s, 0}, {-s, s, 0}, {s, s, 0}};
    m.uvs = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    m.triangles = {{0, 1, 3}, {0, 3, 2}};
    return std::make_shared<const TriangleMesh>(std::move(m));
}

/// A scene with this square, whose height is bilinear over uv.
SceneDescription displaced_square(float edge_length, const Transform& to_world = {}) {
    SceneDescription scene;
    BilerpTexture heights;
    heights.v00 = Rgb(0), heights.v10 = Rgb(1), heights.v01 = Rgb(0), heights.v11 = Rgb(1);
    scene.textures.push_back({"height", false, heights, {}});
    ShapeDescription shape;
    shape.geometry = square(1);
    shape.object_to_world = AnimatedTransform(to_world);
    shape.displacement = Displacement{0, edge_length};
    scene.shapes.push_back(shape);
    return scene;
}

const TriangleMesh& mesh_of(const SceneDescription& scene) {
    return *std::get<std::shared_ptr<const TriangleMesh>>(scene.shapes.at(0).geometry);
}

TEST(Displacement, SplitsEdgesInWorldUnitsWithoutCracks) {
    for (const float scale : {1.0f, 3.0f}) {
        SceneDescription scene = displaced_square(0.3f, Transform::scale(scale, scale, scale));
        displace(scene, TextureStore(scene));
        EXPECT_FALSE(scene.shapes[0].displacement);
        const TriangleMesh& m = mesh_of(scene);
        EXPECT_GT(m.triangles.size(), 8 / (0.3 * 0.3) * scale * scale);
        std::map<std::pair<uint32_t, uint32_t>, int> uses;
        double area = 0;
        for (const auto& t : m.triangles) {
            for (size_t i = 0; i < 3; ++i) {
                const uint32_t a = t[i], b = t[(i + 1) % 3];
                ++uses[{std::min(a, b), std::max(a, b)}];
                const Vec3 flat{m.positions[a].x - m.positions[b].x,
                                m.positions[a].y - m.positions[b].y, 0};
                EXPECT_LT(scale * length(flat), 0.3f);
            }
            const Vec3 n =
                cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]);
            EXPECT_GT(n.z, 0) << "triangles keep their sides";
            area += 0.5 * double(n.z);
        }
        EXPECT_NEAR(area, 4, 1e-3);
        for (const auto& [edge, count] : uses) {
            const auto at_rim = [&](uint32_t v) {
                return std::max(std::abs(m.positions[v].x), std::abs(m.positions[v].y)) > 0.999f;
            };
            EXPECT_EQ(count, at_rim(edge.first) && at_rim(edge.second) && count == 1 ? 1 : 2);
        }
    }
}

TEST(Displacement, MovesVerticesByTheTextureAlongTheirNormals) {
    SceneDescription scene = displaced_square(0.25f);
    displace(scene, TextureStore(scene));
    const TriangleMesh& m = mesh_of(scene);
    const Vec3 slope =
        normalize(Vec3{-0.5f, 0, 1});  // of a height that grows by 1 over a side of 2
    for (size_t i = 0; i < m.positions.size(); ++i) {
        EXPECT_NEAR(m.positions[i].z, (m.positions[i].x + 1) / 2, 1e-5f);
        EXPECT_NEAR(m.uvs[i].x, (m.positions[i].x + 1) / 2, 1e-5f);
        EXPECT_NEAR(length(m.normals[i] - slope), 0, 1e-4f);
    }
}

TEST(Displacement, IsWhatRaysMeet) {
    SceneDescription description = displaced_square(0.2f);
    ObjectDescription object;
    object.shapes = description.shapes;
    description.objects.push_back(object);
    InstanceDescription instance;
    instance.object = 0;
    instance.instance_to_world = AnimatedTransform(Transform::translate({10, 0, 0}));
    description.instances.push_back(instance);
    const LitScene scene(description);
    for (const float x : {0.0f, 10.0f}) {
        SurfaceHit hit;
        ASSERT_TRUE(scene.geometry.intersect({{x + 0.4f, 0.1f, 5}, {0, 0, -1}}, hit));
        EXPECT_NEAR(hit.position.z, 0.7f, 1e-4f);
    }
}

TEST(Displacement, TooManyTrianglesAreRefused) {
    SceneDescription scene = displaced_square(1e-5f);
    try {
        displace(scene, TextureStore(scene));
        FAIL() << "expected an error";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::limit);
    }
}

}  // namespace
}  // namespace covtrace
