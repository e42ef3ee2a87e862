// Surfaces of two sides, made of triangles on each other that are seen from their fronts alone.
#include <gtest/gtest.h>

#include "core/rng.h"
#include "geometry/opposite_triangles.h"
#include "geometry_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// Squares of two triangles each, at heights of 0, 1, ...; every triangle twice, the second time
/// the other way around, from another corner on and with vertices, normals and coordinates of its
/// own, that have v = 1.
ShapeDescription sheets(int count, const AnimatedTransform& transform) {
    TriangleMesh m;
    for (int sheet = 0; sheet < count; ++sheet)
        for (const float v : {0.0f, 1.0f}) {
            const auto first = static_cast<uint32_t>(m.positions.size());
            for (const Vec2 p : {Vec2{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
                m.positions.push_back({p.x, p.y, static_cast<float>(sheet)});
                m.normals.push_back({0, 0, v > 0 ? -1.0f : 1.0f});
                m.uvs.push_back({p.x, v});
            }
            if (v > 0) {
                m.triangles.push_back({first + 3, first + 2, first});
                m.triangles.push_back({first + 1, first, first + 2});
            } else {
                m.triangles.push_back({first, first + 1, first + 2});
                m.triangles.push_back({first, first + 2, first + 3});
            }
        }
    ShapeDescription shape = mesh(m, transform);
    shape.is_seen_from_back = false;
    return shape;
}

void expect_fronts(const AnimatedTransform& transform) {
    constexpr int kSheets = 8;
    const Geometry geometry{scene_of({sheets(kSheets, transform)})};
    const Transform place = transform.start();
    Rng rng(3);
    std::vector<Ray> rays;
    std::vector<SurfaceHit> hits(64);
    for (int i = 0; i < 64; ++i) {
        const Vec2 at = rng.next_2d();
        const float way = i % 2 ? 1.0f : -1.0f;
        const Vec3 from = place.point({at.x, at.y, static_cast<float>(i % kSheets) - 0.5f * way});
        rays.push_back({from, normalize(place.vector({0.1f, 0, way}))});
    }
    std::vector<HitQuery> queries;
    for (size_t i = 0; i < rays.size(); ++i) queries.push_back({&rays[i], &hits[i], false});
    geometry.intersect(queries);
    int found = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        SurfaceHit alone;
        ASSERT_EQ(geometry.intersect(rays[i], alone), queries[i].found);
        if (!queries[i].found) continue;
        ++found;
        for (const SurfaceHit& hit : {alone, hits[i]}) {
            EXPECT_LT(dot(hit.ng, rays[i].direction), 0);
            EXPECT_LT(dot(hit.ns, rays[i].direction), 0);
            EXPECT_NEAR(hit.uv.y, i % 2 ? 1 : 0, 1e-5f);
            const Vec3 local = place.inverse().point(hit.position);
            EXPECT_NEAR(hit.uv.x, local.x, 1e-5f);
        }
    }
    EXPECT_GT(found, 50);
}

TEST(GeometryOppositeTriangles, RaysMeetTheFrontOnEitherSide) {
    expect_fronts({});
    expect_fronts(
        AnimatedTransform(chain({Transform::rotate(40, {1, 2, 3}), Transform::scale(2, 1.5f, 1),
                                 Transform::translate({1, 2, 3})})));
}

TEST(GeometryOppositeTriangles, MirroredShapesKeepTheirFronts) {
    expect_fronts(AnimatedTransform(Transform::scale(-1, 1, 1)));
}

TEST(GeometryOppositeTriangles, OthersAreNone) {
    // The same triangle twice, the same way around, and a fan without area.
    TriangleMesh m = unit_triangle();
    m.triangles = {{0, 1, 2}, {1, 2, 0}, {0, 1, 1}, {1, 1, 0}};
    EXPECT_EQ(OppositeTriangles::of(m), nullptr);
    m.triangles.push_back({1, 0, 2});
    const auto pairs = OppositeTriangles::of(m);
    ASSERT_NE(pairs, nullptr);
    const auto [primitive, place] = pairs->at(m, 0, {0.125f, 0.5f});
    EXPECT_EQ(primitive, 4u);
    EXPECT_EQ(place, (Vec2{0.375f, 0.5f}));
    EXPECT_EQ(pairs->at(m, 2, {0.25f, 0.5f}).first, 2u);
}

}  // namespace
}  // namespace covtrace
