// Shading tangents that a mesh has of its own.
#include <gtest/gtest.h>

#include "geometry_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

void expect_near(Vec3 a, Vec3 b, float tolerance = 1e-6f) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "axis " << i;
}

SurfaceHit must_hit(const Geometry& g, Vec3 origin, float time = 0) {
    SurfaceHit hit;
    EXPECT_TRUE(g.intersect({origin, {0, 0, -1}, time}, hit));
    return hit;
}

TEST(GeometryTangents, AreForShadingOnly) {
    TriangleMesh m = unit_triangle();
    const SurfaceHit plain = must_hit(Geometry{scene_of({mesh(m)})}, {0.25f, 0.5f, 3});
    EXPECT_EQ(plain.tangent, plain.dpdu);
    // The hit has b = (0.25, 0.25, 0.5) on (0,0), (1,0), (1,1).
    m.tangents = {{0, 1, 0}, {0, 1, 0}, {2, 1, 1}};
    const SurfaceHit own = must_hit(Geometry{scene_of({mesh(m)})}, {0.25f, 0.5f, 3});
    expect_near(own.tangent, {1, 1, 0.5f});
    EXPECT_EQ(own.dpdu, plain.dpdu);
    EXPECT_EQ(own.ns, plain.ns);
    // A tangent of no length is none.
    m.tangents = {{}, {}, {}};
    EXPECT_EQ(must_hit(Geometry{scene_of({mesh(m)})}, {0.25f, 0.5f, 3}).tangent, plain.dpdu);
}

TEST(GeometryTangents, AreVectorsOfTheObject) {
    // A scale stretches them, a reversed orientation does not turn them, a motion carries them.
    TriangleMesh m = unit_triangle();
    m.tangents = {{0, 1, 0}, {0, 1, 0}, {2, 1, 1}};
    ShapeDescription stretched = mesh(m, AnimatedTransform(Transform::scale(2, 1, 1)));
    stretched.reverse_orientation = true;
    const Geometry still{scene_of({stretched})};
    expect_near(must_hit(still, {0.5f, 0.5f, 3}).tangent, {2, 1, 0.5f});
    const AnimatedTransform turning({}, 0, Transform::rotate(90, {0, 0, 1}), 1);
    const Geometry moving{scene_of({mesh(m, turning)})};
    expect_near(must_hit(moving, {-0.5f, 0.25f, 3}, 1).tangent, {-1, 1, 0.5f}, 1e-4f);
}

}  // namespace
}  // namespace covtrace
