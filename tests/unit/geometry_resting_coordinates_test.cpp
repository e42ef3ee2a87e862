// Texture coordinates that are the same all over a primitive, or along it.
#include <gtest/gtest.h>

#include "geometry_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// A hit on a triangle of such coordinates, the right angle at the origin and sides of 1 in x, y.
SurfaceHit hit_on(const std::vector<Vec2>& uvs) {
    TriangleMesh m = unit_triangle();
    m.uvs = uvs;
    const Geometry geometry{scene_of({mesh(m)})};
    SurfaceHit hit;
    EXPECT_TRUE(geometry.intersect({{0.25f, 0.5f, 3}, {0, 0, -1}}, hit));
    return hit;
}

TEST(GeometryRestingCoordinates, HaveLongTangents) {
    // A pixel's footprint in (u, v) would else be as wide as in the scene's unit: in models in
    // centimetres, parts that had one colour of a palette each showed means of several.
    const SurfaceHit hit = hit_on({{0.3f, 0.3f}, {0.3f, 0.3f}, {0.3f, 0.3f}});
    EXPECT_GT(length(hit.dpdu), 500);
    EXPECT_GT(length(hit.dpdv), 500);
    EXPECT_NEAR(dot(normalize(hit.dpdu), normalize(hit.dpdv)), 0, 1e-6f);
    EXPECT_NEAR(dot(normalize(hit.dpdu), hit.ng), 0, 1e-6f);
    EXPECT_GT(dot(cross(hit.dpdu, hit.dpdv), hit.ng), 0);
}

TEST(GeometryRestingCoordinates, ChangeAcrossTheLineAlongWhichTheyRest) {
    // v grows by 1/2 a unit of x, and u rests.
    const SurfaceHit hit = hit_on({{0.25f, 0}, {0.25f, 0.5f}, {0.25f, 0}});
    EXPECT_LT(distance(hit.dpdv, {2, 0, 0}), 1e-5f);
    EXPECT_GT(length(hit.dpdu), 500);
    EXPECT_NEAR(dot(normalize(hit.dpdu), {0, -1, 0}), 1, 1e-5f);
    EXPECT_NEAR(dot(hit.dpdu, hit.ng), 0, 1e-6f);
}

}  // namespace
}  // namespace covtrace
