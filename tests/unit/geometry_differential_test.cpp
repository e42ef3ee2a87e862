#include <gtest/gtest.h>

#include "geometry_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// The shape operator and d(uv), by moving the ray sideways in the tangent plane.
struct Numeric {
    float k[2][2], uv[2][2];
};

Numeric numeric_derivatives(const Geometry& g, const SurfaceHit& hit, const Frame& frame, float h) {
    Numeric out{};
    for (int j = 0; j < 2; ++j) {
        const Vec3 axis = j == 0 ? frame.x : frame.y;
        SurfaceHit side[2];
        for (int s = 0; s < 2; ++s) {
            const Vec3 origin = hit.position + axis * (s == 0 ? -h : h) + hit.ns * 0.2f;
            EXPECT_TRUE(g.intersect({origin, -hit.ns, hit.time}, side[s]));
        }
        const Vec3 dn = (side[1].ns - side[0].ns) / (2 * h);
        const Vec2 duv = (side[1].uv - side[0].uv) * (0.5f / h);
        out.k[0][j] = dot(dn, frame.x);
        out.k[1][j] = dot(dn, frame.y);
        out.uv[0][j] = duv.x;
        out.uv[1][j] = duv.y;
    }
    return out;
}

void expect_matches_numeric(const Geometry& g, Vec3 origin, Vec3 direction, float tolerance) {
    SurfaceHit hit;
    ASSERT_TRUE(g.intersect({origin, normalize(direction), 0.4f}, hit));
    const DifferentialGeometry d = g.differential(hit);
    EXPECT_NEAR(dot(d.tangent.z, hit.ns), 1, 1e-6f);
    const Numeric n = numeric_derivatives(g, hit, d.tangent, 4e-3f);
    const float scale = 1 + std::abs(d.k11) + std::abs(d.k22);
    EXPECT_NEAR(d.k11, n.k[0][0], tolerance * scale);
    EXPECT_NEAR(d.k22, n.k[1][1], tolerance * scale);
    EXPECT_NEAR(d.k12, 0.5f * (n.k[0][1] + n.k[1][0]), tolerance * scale);
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j)
            EXPECT_NEAR(d.uv_from_tangent[i][j], n.uv[i][j],
                        tolerance * (1 + std::abs(n.uv[i][j])));
}

TEST(GeometryDifferential, SphereIsOneOverRadius) {
    for (bool reverse : {false, true}) {
        ShapeDescription s = shape(sphere(2.5f));
        s.reverse_orientation = reverse;
        const Geometry g{scene_of({s})};
        for (Vec3 o : {Vec3{0, 0, 9}, Vec3{5, 5, 5}, Vec3{-7, 1, -3}}) {
            SurfaceHit hit;
            ASSERT_TRUE(g.intersect({o, normalize(-o)}, hit));
            const DifferentialGeometry d = g.differential(hit);
            EXPECT_NEAR(d.k11, reverse ? -0.4f : 0.4f, 1e-5f);
            EXPECT_NEAR(d.k22, reverse ? -0.4f : 0.4f, 1e-5f);
            EXPECT_NEAR(d.k12, 0, 1e-5f);
            EXPECT_EQ(d.velocity, Vec3{});
            EXPECT_EQ(d.angular_velocity, Vec3{});
        }
    }
}

TEST(GeometryDifferential, EllipsoidAgainstFiniteDifferences) {
    const Transform place =
        chain({Transform::translate({1, 2, 3}), Transform::rotate(50, {1, -1, 2}),
               Transform::scale(2, 0.7, -1.3)});
    const AnimatedTransform moving(place, 0, Transform::rotate(20, {1, 0, 0}) * place, 1);
    for (const AnimatedTransform& t : {AnimatedTransform(place), moving})
        for (bool reverse : {false, true}) {
            ShapeDescription s = shape(sphere(1), t);
            s.reverse_orientation = reverse;
            const Geometry g{scene_of({s})};
            const Vec3 center = t.at(0.4f).point({0, 0, 0});
            for (Vec3 d : {Vec3{1, 0.3f, 0.2f}, Vec3{-1, 2, 1}, Vec3{0.2f, -0.4f, -1}})
                if (!reverse) expect_matches_numeric(g, center + d * 4.0f, -d, 0.01f);
        }
}

TEST(GeometryDifferential, DiskAndFlatTriangleAreFlat) {
    const Transform place = Transform::rotate(30, {1, 1, 0}) * Transform::scale(1, 2, 3);
    const Geometry disk{scene_of({shape(Disk{0.5f, 2, 0, 360}, AnimatedTransform(place))})};
    const Vec3 p = place.point({0.7f, 0.5f, 0.5f}), n = normalize(place.normal({0, 0, 1}));
    expect_matches_numeric(disk, p + n, -n, 0.01f);
    SurfaceHit hit;
    ASSERT_TRUE(disk.intersect({p + n, -n}, hit));
    EXPECT_EQ(disk.differential(hit).k11, 0);
    EXPECT_EQ(disk.differential(hit).k22, 0);
    TriangleMesh m = unit_triangle();
    m.uvs = {{0, 0}, {3, 1}, {1, 2}};
    expect_matches_numeric(Geometry{scene_of({mesh(m, AnimatedTransform(place))})},
                           place.point({0.3f, 0.3f, 0}) + n * 2.0f, -n, 0.01f);
}

TEST(GeometryDifferential, FinelyTessellatedSphere) {
    const float radius = 3;
    TriangleMesh with_uvs = sphere_mesh(radius, 60, 120), without = with_uvs;
    without.uvs.clear();
    for (const TriangleMesh& m : {with_uvs, without})
        for (float sign : {1.0f, -1.0f}) {
            TriangleMesh turned = m;
            for (Vec3& n : turned.normals) n = n * (sign * 5);  // vertex normals need not be unit
            const Geometry g{scene_of({mesh(turned)})};
            Random random(6);
            for (int i = 0; i < 500; ++i) {
                Vec3 d = random.direction();
                if (std::abs(d.z) > 0.95f) continue;
                SurfaceHit hit;
                ASSERT_TRUE(g.intersect({d * 9.0f, -d}, hit));
                const DifferentialGeometry c = g.differential(hit);
                ASSERT_NEAR(c.k11, sign / radius, 0.05f / radius);
                ASSERT_NEAR(c.k22, sign / radius, 0.05f / radius);
                ASSERT_NEAR(c.k12, 0, 0.05f / radius);
            }
        }
}

TEST(GeometryDifferential, TwistedPatchAgainstFiniteDifferences) {
    BilinearMesh m = patch({0, 0, 0}, {2, 0, 1}, {0, 2, 1}, {2.5f, 2, -1});
    const Transform place = Transform::rotate(70, {1, 2, 0}) * Transform::scale(1, -1.5, 1);
    for (bool with_uvs : {false, true}) {
        if (with_uvs) m.uvs = {{0, 0}, {2, 0.5f}, {0.1f, 1}, {2.2f, 3}};
        const Geometry g{scene_of({patches(m, AnimatedTransform(place))})};
        for (Vec2 b : {Vec2{0.5f, 0.5f}, Vec2{0.2f, 0.7f}, Vec2{0.8f, 0.1f}}) {
            const auto& c = m.positions;
            const Vec3 p = lerp(b.y, lerp(b.x, c[0], c[1]), lerp(b.x, c[2], c[3]));
            const Vec3 n =
                cross(lerp(b.y, c[1] - c[0], c[3] - c[2]), lerp(b.x, c[2] - c[0], c[3] - c[1]));
            const Vec3 world_n = normalize(place.normal(n));
            expect_matches_numeric(g, place.point(p) + world_n * 0.1f, -world_n, 0.02f);
        }
    }
}

TEST(GeometryDifferential, PatchWithVertexNormals) {
    BilinearMesh m = patch({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0});
    m.normals = {{-0.2f, -0.1f, 1}, {0.2f, -0.1f, 1}, {-0.2f, 0.1f, 1}, {0.2f, 0.1f, 1}};
    SurfaceHit hit;
    const Geometry g{scene_of({patches(m)})};
    ASSERT_TRUE(g.intersect({{0.5f, 0.5f, 1}, {0, 0, -1}}, hit));
    const DifferentialGeometry d = g.differential(hit);
    EXPECT_NEAR(d.k11, 0.4f, 1e-5f);
    EXPECT_NEAR(d.k22, 0.2f, 1e-5f);
}

TEST(GeometryDifferential, DegenerateInputsStayFinite) {
    TriangleMesh m = unit_triangle();
    m.uvs.assign(3, {0.5f, 0.5f});
    m.normals = {{0, 0, 1}, {0, 0, 0}, {0, 0, -1}};
    const Geometry g{
        scene_of({mesh(m), shape(sphere(1), AnimatedTransform(Transform::translate({5, 0, 0})))})};
    for (Vec3 o : {Vec3{0.2f, 0.3f, 4}, Vec3{0.3f, 0.5f, 4}, Vec3{5, 0, 4}}) {
        SurfaceHit hit;
        ASSERT_TRUE(g.intersect({o, {0, 0, -1}}, hit));
        const DifferentialGeometry d = g.differential(hit);
        EXPECT_TRUE(std::isfinite(d.k11) && std::isfinite(d.k12) && std::isfinite(d.k22));
        EXPECT_TRUE(is_finite(d.tangent.x) && is_finite(d.tangent.y));
        for (const auto& row : d.uv_from_tangent)
            for (float v : row) EXPECT_TRUE(std::isfinite(v));
    }
    SurfaceHit hit;
    ASSERT_TRUE(g.intersect({{0.2f, 0.3f, 4}, {0, 0, -1}}, hit));
    EXPECT_EQ(g.differential(hit).uv_from_tangent[0][0], 0);  // constant uv
}

}  // namespace
}  // namespace covtrace
