// Rays of different kinds meet the shapes that are there for them.
#include <gtest/gtest.h>

#include <array>
#include <iterator>
#include <string>

#include "geometry_fixtures.h"

namespace covtrace::test {
namespace {

constexpr RayKinds kNone = set_of(RayKind::any);
constexpr RayKind kKinds[] = {RayKind::camera,       RayKind::diffuse, RayKind::glossy,
                              RayKind::transmission, RayKind::volume,  RayKind::shadow};

TriangleMesh square(float z) {
    TriangleMesh m;
    m.positions = {{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}};
    m.triangles = {{0, 1, 2}, {0, 2, 3}};
    return m;
}

/// Squares at z = 0, 1, 2 …, each there for one of the kinds.
std::vector<ShapeDescription> one_for_each_kind() {
    std::vector<ShapeDescription> shapes;
    for (RayKind kind : kKinds) {
        shapes.push_back(mesh(square(float(shapes.size()))));
        shapes.back().visible_to = static_cast<RayKinds>(kNone | set_of(kind));
    }
    return shapes;
}

Ray ray_of(RayKind kind) {
    return {{0.2f, 0.1f, -1}, {0, 0, 1}, 0, kInfinity, kind};
}

void expect_own_squares(const Geometry& g, const std::string& what) {
    for (size_t i = 0; i < std::size(kKinds); ++i) {
        SurfaceHit hit;
        ASSERT_TRUE(g.intersect(ray_of(kKinds[i]), hit)) << what << i;
        EXPECT_NEAR(hit.position.z, float(i), 1e-5f) << what << i;
        HitQuery query{nullptr, &hit};
        const Ray ray = ray_of(kKinds[i]);
        query.ray = &ray;
        std::array<HitQuery, 2> both{query, query};
        g.intersect_seen(both);
        EXPECT_TRUE(both[1].found);
        EXPECT_NEAR(hit.position.z, float(i), 1e-5f) << what << i;
    }
    SurfaceHit hit;
    ASSERT_TRUE(g.intersect(ray_of(RayKind::any), hit));
    EXPECT_NEAR(hit.position.z, 0, 1e-5f) << "rays of any kind meet all of them";
    // The shadow's own square is the sixth, whatever the kind of the ray.
    Ray shadow = ray_of(RayKind::diffuse);
    shadow.t_max = 5.9f;
    EXPECT_FALSE(g.occluded(shadow)) << what;
    shadow.t_max = 6.1f;
    EXPECT_TRUE(g.occluded(shadow)) << what;
    EXPECT_TRUE(g.kinds_differ());
    EXPECT_TRUE(g.shadows_differ());
}

TEST(GeometryRayKinds, EachMeetsItsOwn) {
    expect_own_squares(Geometry(scene_of(one_for_each_kind())), "square ");
}

TEST(GeometryRayKinds, WithAlphaAndInInstancesToo) {
    auto shapes = one_for_each_kind();
    for (ShapeDescription& s : shapes) s.alpha = 0;
    SceneDescription scene = scene_of({});
    TextureDescription half;
    half.is_spectrum = false;
    half.value = ConstantTexture{Rgb(0.5f)};
    scene.textures = {half};
    scene.objects.push_back({"pile", shapes});
    scene.instances.push_back({0, AnimatedTransform(), {}});
    Geometry g(scene);
    g.set_alpha([](TextureId, const AlphaPlace&) { return 1.0f; });
    expect_own_squares(g, "instanced square ");
}

TEST(GeometryRayKinds, WhatIsThereForNoneIsLeftOut) {
    std::vector<ShapeDescription> shapes{mesh(square(0)), mesh(square(1))};
    shapes[0].visible_to = kNone;
    const Geometry g(scene_of(std::move(shapes)));
    SurfaceHit hit;
    ASSERT_TRUE(g.intersect(ray_of(RayKind::any), hit));
    EXPECT_EQ(hit.shape, 1u);
    EXPECT_FALSE(g.kinds_differ());
    EXPECT_FALSE(g.shadows_differ());
}

TEST(GeometryRayKinds, EmittersThatLetLightPassStopNothing) {
    std::vector<ShapeDescription> shapes{mesh(square(0)), mesh(square(1))};
    shapes[0].area_light = 0;
    SceneDescription scene = scene_of(std::move(shapes));
    scene.area_lights.emplace_back().lets_light_pass = true;
    const Geometry g(scene);
    SurfaceHit hit;
    ASSERT_TRUE(g.intersect(ray_of(RayKind::glossy), hit));
    EXPECT_TRUE(g.shapes()[hit.shape].lets_light_pass);
    ASSERT_TRUE(g.intersect(ray_of(RayKind::any), hit));
    EXPECT_EQ(hit.shape, 1u);
    Ray shadow = ray_of(RayKind::shadow);
    shadow.t_max = 1.9f;
    EXPECT_FALSE(g.occluded(shadow));
    EXPECT_FALSE(g.kinds_differ());
    EXPECT_FALSE(g.shadows_differ());
}

}  // namespace
}  // namespace covtrace::test
