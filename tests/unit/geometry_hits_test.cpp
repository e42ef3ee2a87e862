#include <gtest/gtest.h>

#include "geometry_fixtures.h"
#include "pbrt/loop_subdivision.h"

namespace covtrace {
namespace {

using namespace test;

::testing::AssertionResult near_vec(Vec3 a, Vec3 b, float tolerance) {
    if (distance(a, b) <= tolerance) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "(" << a.x << ", " << a.y << ", " << a.z << ") is not ("
                                         << b.x << ", " << b.y << ", " << b.z << ")";
}

SurfaceHit must_hit(const Geometry& g, Vec3 origin, Vec3 direction, float time = 0) {
    SurfaceHit hit;
    const bool found = g.intersect({origin, normalize(direction), time}, hit);
    EXPECT_TRUE(found);
    return hit;
}

TEST(GeometryHits, EmptySceneHasNoHitAndAUnitBox) {
    const Geometry g{SceneDescription{}};
    SurfaceHit hit;
    EXPECT_FALSE(g.intersect({{0, 0, 0}, {0, 0, 1}}, hit));
    EXPECT_FALSE(g.occluded({{0, 0, 0}, {0, 0, 1}}));
    EXPECT_EQ(g.bounds().lo, (Vec3{-0.5f, -0.5f, -0.5f}));
    EXPECT_EQ(g.bounds().hi, (Vec3{0.5f, 0.5f, 0.5f}));
}

TEST(GeometryHits, ShapesWithoutPrimitivesAreHarmless) {
    const Geometry g{scene_of({mesh({}), patches({})})};
    SurfaceHit hit;
    EXPECT_FALSE(g.intersect({{0, 0, 0}, {0, 0, 1}}, hit));
    EXPECT_EQ(g.shapes().size(), 2u);
}

TEST(GeometryHits, TheInstructionSetCanBeChosen) {
    EXPECT_NO_THROW(Geometry(SceneDescription{}, "sse2"));
}

TEST(GeometryHits, TrianglePositionUvAndTangents) {
    TriangleMesh m = unit_triangle();
    m.uvs = {{0.1f, 0.2f}, {0.5f, 0.2f}, {0.1f, 1.0f}};
    const Geometry g{scene_of({mesh(m)})};
    const SurfaceHit hit = must_hit(g, {0.25f, 0.5f, 3}, {0, 0, -1});
    EXPECT_FLOAT_EQ(hit.t, 3);
    EXPECT_TRUE(near_vec(hit.position, {0.25f, 0.5f, 0}, 1e-6f));
    EXPECT_TRUE(near_vec(hit.ng, {0, 0, 1}, 1e-6f));
    EXPECT_NEAR(hit.uv.x, 0.2f, 1e-6f);
    EXPECT_NEAR(hit.uv.y, 0.6f, 1e-6f);
    EXPECT_TRUE(near_vec(hit.dpdu, {2.5f, 0, 0}, 1e-5f));
    EXPECT_TRUE(near_vec(hit.dpdv, {0, 1.25f, 0}, 1e-5f));
}

TEST(GeometryHits, CamerasDoNotSeeThePlaneThatTheyStandOn) {
    // Two slopes one behind the other; the first holds the eye but for roundings.
    const Transform slope = Transform::rotate(17, {1, 0, 0});
    const auto slanted = [&](float height) {
        TriangleMesh m;
        for (const Vec3 p :
             {Vec3{-3, -3, height}, {3, -3, height}, {3, 3, height}, {-3, 3, height}})
            m.positions.push_back(slope.point(p));
        m.triangles = {{0, 1, 2}, {0, 2, 3}};
        return m;
    };
    const Geometry g{scene_of({mesh(slanted(0.7f)), mesh(slanted(-1))})};
    const Vec3 down = slope.vector({0, 0, -1});
    for (const Vec3 at : {Vec3{0.37f, 0.61f, 0.7f}, {1.3f, -2.1f, 0.7f}, {0, 0, 0.7f}}) {
        const Ray ray{slope.point(at), down};
        SurfaceHit hit;
        ASSERT_TRUE(g.intersect_seen(ray, hit));
        EXPECT_EQ(hit.shape, 1u);
        EXPECT_NEAR(hit.t, 1.7f, 1e-5f);
        const Ray up{ray.origin, -down};
        EXPECT_FALSE(g.intersect_seen(up, hit));
        // The slope is seen from a thousandth above it.
        ASSERT_TRUE(g.intersect_seen({ray.origin - 1e-3f * down, down}, hit));
        EXPECT_EQ(hit.shape, 0u);
    }
}

TEST(GeometryHits, TriangleDefaultUvsAreThoseOfPbrt) {
    const Geometry g{scene_of({mesh(unit_triangle())})};
    const SurfaceHit hit = must_hit(g, {0.25f, 0.5f, 3}, {0, 0, -1});
    // The hit has b = (0.25, 0.25, 0.5) on (0,0), (1,0), (1,1).
    EXPECT_NEAR(hit.uv.x, 0.75f, 1e-6f);
    EXPECT_NEAR(hit.uv.y, 0.5f, 1e-6f);
    EXPECT_TRUE(near_vec(hit.dpdu, {1, 0, 0}, 1e-6f));
    EXPECT_TRUE(near_vec(hit.dpdv, {-1, 1, 0}, 1e-6f));
}

TEST(GeometryHits, OrientationOfTriangles) {
    const Vec3 up{0, 0, 1};
    const AnimatedTransform mirror(Transform::scale(-1, 1, 1));
    const auto normal = [](ShapeDescription s, float x) {
        return must_hit(Geometry{scene_of({std::move(s)})}, {x, 0.25f, 3}, {0, 0, -1}).ng;
    };
    ShapeDescription plain = mesh(unit_triangle()), mirrored = mesh(unit_triangle(), mirror);
    EXPECT_EQ(normal(plain, 0.25f), up);
    EXPECT_EQ(normal(mirrored, -0.25f), up);  // a mirror doesn't swap inside and outside
    plain.reverse_orientation = mirrored.reverse_orientation = true;
    EXPECT_EQ(normal(plain, 0.25f), -up);
    EXPECT_EQ(normal(mirrored, -0.25f), -up);
    EXPECT_TRUE(Geometry{scene_of({plain})}.shapes()[0].flip_normal);
    EXPECT_FALSE(Geometry{scene_of({mirrored})}.shapes()[0].flip_normal);
}

TEST(GeometryHits, VertexNormalsDecideTheSide) {
    TriangleMesh m = unit_triangle();
    m.normals = {{0.6f, 0, -0.8f}, {0.6f, 0, -0.8f}, {0.6f, 0, -0.8f}};
    ShapeDescription s = mesh(m);
    SurfaceHit hit = must_hit(Geometry{scene_of({s})}, {0.25f, 0.25f, 3}, {0, 0, -1});
    EXPECT_TRUE(near_vec(hit.ns, {0.6f, 0, -0.8f}, 1e-6f));
    EXPECT_TRUE(near_vec(hit.ng, {0, 0, -1}, 1e-6f));
    s.reverse_orientation = true;
    hit = must_hit(Geometry{scene_of({s})}, {0.25f, 0.25f, 3}, {0, 0, -1});
    EXPECT_TRUE(near_vec(hit.ns, {-0.6f, 0, 0.8f}, 1e-6f));
    EXPECT_TRUE(near_vec(hit.ng, {0, 0, 1}, 1e-6f));
}

TEST(GeometryHits, TheOutsideOfSubdividedMeshesIsPbrts) {
    // The corners are seen counterclockwise from +z: this is a plain mesh's outside, and the inside
    // of the mesh with pbrt's limit normals, which decide.
    ShapeDescription plain = mesh(unit_triangle());
    const TriangleMesh& m = *std::get<std::shared_ptr<const TriangleMesh>>(plain.geometry);
    ShapeDescription fine = mesh(loop_subdivide(m.positions, m.triangles, 2, {}));
    const auto normal = [](const ShapeDescription& s, float x) {
        return must_hit(Geometry{scene_of({s})}, {x, 0.25f, 3}, {0, 0, -1}).ng;
    };
    const Vec3 up{0, 0, 1};
    EXPECT_TRUE(near_vec(normal(plain, 0.25f), up, 1e-6f));
    EXPECT_TRUE(near_vec(normal(fine, 0.25f), -up, 1e-6f));
    fine.reverse_orientation = true;
    EXPECT_TRUE(near_vec(normal(fine, 0.25f), up, 1e-6f));
    fine.object_to_world = AnimatedTransform(Transform::scale(-1, 1, 1));
    EXPECT_TRUE(near_vec(normal(fine, -0.25f), up, 1e-6f));
}

TEST(GeometryHits, VanishingVertexNormalsFallBackToTheFace) {
    TriangleMesh m = unit_triangle();
    m.normals = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    const SurfaceHit hit = must_hit(Geometry{scene_of({mesh(m)})}, {0.25f, 0.25f, 3}, {0, 0, -1});
    EXPECT_EQ(hit.ns, (Vec3{0, 0, 1}));
    EXPECT_EQ(hit.ng, (Vec3{0, 0, 1}));
}

TEST(GeometryHits, NormalsGoByTheInverseTranspose) {
    const Transform squash = Transform::scale(1, 1, 4) * Transform::rotate(45, {0, 1, 0});
    TriangleMesh m = unit_triangle();
    m.normals.assign(3, {0, 0, 1});
    for (const AnimatedTransform& t :
         {AnimatedTransform(squash),
          AnimatedTransform(squash, 0.0f, Transform::translate({1, 0, 0}) * squash, 1.0f)}) {
        const Geometry g{scene_of({mesh(m, t)})};
        const Vec3 target = squash.point({0.25f, 0.25f, 0});
        const SurfaceHit hit = must_hit(g, target + Vec3{0, 0, 3}, {0, 0, -1});
        EXPECT_TRUE(near_vec(hit.ng, normalize(squash.normal({0, 0, 1})), 2e-6f));
        EXPECT_TRUE(near_vec(hit.ns, hit.ng, 2e-6f));
    }
}

TEST(GeometryHits, SphereAgainstTheClosedForm) {
    Random random(1);
    const Transform place =
        chain({Transform::translate({3, -2, 5}), Transform::rotate(35, {1, 2, 3})});
    const Geometry g{scene_of({shape(sphere(2), AnimatedTransform(place))})};
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3 center{3, -2, 5};
        const Vec3 origin = center + random.direction() * random.between(2.5f, 50);
        const Vec3 d = normalize(center + random.in_box(2.5f) - origin);
        const auto inner = [](Vec3 a, Vec3 c) {
            return double(a.x) * c.x + double(a.y) * c.y + double(a.z) * c.z;
        };
        const Vec3 o = origin - center;
        const double a = inner(d, d), b = -inner(o, d) / a, h2 = (4.0 - inner(o, o)) / a + b * b;
        if (std::abs(h2) < 1e-3) continue;
        SurfaceHit hit;
        // The point aimed at may lie on this side of the sphere, which is then behind.
        const bool hits_sphere = h2 > 0 && b > 0;
        ASSERT_EQ(g.intersect({origin, d}, hit), hits_sphere);
        if (!hits_sphere) continue;
        ++hits;
        ASSERT_NEAR(hit.t, b - std::sqrt(h2), 1e-4 / std::sqrt(h2));
        ASSERT_NEAR(distance(hit.position, center), 2, 2e-6f);
        ASSERT_TRUE(near_vec(hit.ng, (hit.position - center) / 2, 2e-6f));
        ASSERT_GT(dot(cross(hit.dpdu, hit.dpdv), hit.ng), 0);
    }
    EXPECT_GT(hits, 5000);
}

TEST(GeometryHits, SphereParameterisationOfPbrt) {
    const Geometry g{scene_of({shape(Sphere{1, -0.5f, 0.5f, 180})})};
    const SurfaceHit hit = must_hit(g, {0, 3, 0}, {0, -1, 0});
    EXPECT_NEAR(hit.uv.x, 0.5f, 1e-6f);  // phi = 90 of 180 degrees
    EXPECT_NEAR(hit.uv.y, 0.5f, 1e-6f);  // the equator
    const float span = 2 * (kPi / 2 - std::acos(0.5f));
    EXPECT_TRUE(near_vec(hit.dpdu, {-kPi, 0, 0}, 1e-5f));
    EXPECT_TRUE(near_vec(hit.dpdv, {0, 0, span}, 1e-5f));
}

TEST(GeometryHits, PartialSphereShowsItsInside) {
    const Geometry g{scene_of({shape(Sphere{1, -0.5f, 0.5f, 180})})};
    SurfaceHit hit;
    EXPECT_FALSE(g.intersect({{0, 0.1f, 3}, {0, 0, -1}}, hit));  // both caps are cut off
    hit = must_hit(g, {0, -3, 0}, {0, 1, 0});                    // phi = 270 degrees is missing
    EXPECT_TRUE(near_vec(hit.position, {0, 1, 0}, 1e-6f));
    EXPECT_FALSE(g.occluded({{0, -3, 0}, {0, 1, 0}, 0, 3.9f}));
    EXPECT_TRUE(g.occluded({{0, -3, 0}, {0, 1, 0}, 0, 4.1f}));
}

TEST(GeometryHits, SpherePolesHaveFiniteTangents) {
    const SurfaceHit hit = must_hit(Geometry{scene_of({shape(sphere(1))})}, {0, 0, 3}, {0, 0, -1});
    EXPECT_TRUE(near_vec(hit.ng, {0, 0, 1}, 2e-5f));
    EXPECT_TRUE(is_finite(hit.dpdu) && is_finite(hit.dpdv));
    EXPECT_GT(length(hit.dpdu), 0);
    EXPECT_GT(length(hit.dpdv), 0);
}

TEST(GeometryHits, MirroredSphereKeepsItsOutside) {
    const AnimatedTransform mirror(Transform::scale(1, -1, 1));
    ShapeDescription s = shape(sphere(1), mirror);
    EXPECT_TRUE(near_vec(must_hit(Geometry{scene_of({s})}, {0, 0.1f, 3}, {0, 0, -1}).ng,
                         {0, 0.1f, std::sqrt(0.99f)}, 1e-6f));
    s.reverse_orientation = true;
    EXPECT_LT(must_hit(Geometry{scene_of({s})}, {0, 0.1f, 3}, {0, 0, -1}).ng.z, 0);
}

TEST(GeometryHits, DiskWithHoleAndSector) {
    const Geometry g{scene_of({shape(Disk{1, 2, 0.5f, 90})})};
    const SurfaceHit hit = must_hit(g, {1, 1, 4}, {0, 0, -1});
    EXPECT_TRUE(near_vec(hit.position, {1, 1, 1}, 1e-6f));
    EXPECT_TRUE(near_vec(hit.ng, {0, 0, 1}, 1e-6f));
    EXPECT_NEAR(hit.uv.x, 0.5f, 1e-6f);
    EXPECT_NEAR(hit.uv.y, (2 - std::sqrt(2.0f)) / 1.5f, 1e-6f);
    EXPECT_TRUE(near_vec(hit.dpdu, Vec3{-1, 1, 0} * (kPi / 2), 1e-5f));
    EXPECT_TRUE(near_vec(hit.dpdv, normalize(Vec3{-1, -1, 0}) * 1.5f, 1e-5f));
    SurfaceHit none;
    for (Vec3 o : {Vec3{0.2f, 0.2f, 4}, Vec3{-1, 1, 4}, Vec3{1.5f, 1.5f, 4}})
        EXPECT_FALSE(g.intersect({o, {0, 0, -1}}, none));
}

TEST(GeometryHits, ParallelogramPatch) {
    const Geometry g{scene_of({patches(patch({0, 0, 0}, {2, 0, 0}, {1, 3, 0}, {3, 3, 0}))})};
    Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const float u = random.next(), v = random.next();
        const Vec3 p{2 * u + v, 3 * v, 0};
        const SurfaceHit hit = must_hit(g, p + Vec3{0.1f, 0.2f, 2}, Vec3{-0.1f, -0.2f, -2});
        ASSERT_NEAR(hit.uv.x, u, 3e-6f);
        ASSERT_NEAR(hit.uv.y, v, 3e-6f);
        ASSERT_TRUE(near_vec(hit.position, p, 1e-5f));
        ASSERT_TRUE(near_vec(hit.ng, {0, 0, 1}, 1e-6f));
        ASSERT_TRUE(near_vec(hit.dpdv, {1, 3, 0}, 1e-5f));
    }
}

TEST(GeometryHits, TwistedAndPlanarPatchesAgainstTheirParameters) {
    const Vec3 twisted[4] = {{0, 0, 0}, {2, 0, 1}, {0, 2, 1}, {2.5f, 2, -1}};
    const Vec3 planar[4] = {{0, 0, 0}, {3, 0, 0}, {1, 2, 0}, {2, 2, 0}};
    for (const auto& c : {twisted, planar}) {
        const Geometry g{scene_of({patches(patch(c[0], c[1], c[2], c[3]))})};
        Random random(3);
        for (int i = 0; i < 2000; ++i) {
            const float u = random.next(), v = random.next();
            const Vec3 p = lerp(v, lerp(u, c[0], c[1]), lerp(u, c[2], c[3]));
            const Vec3 du = lerp(v, c[1] - c[0], c[3] - c[2]),
                       dv = lerp(u, c[2] - c[0], c[3] - c[1]);
            const Vec3 n = normalize(cross(du, dv));
            const SurfaceHit hit = must_hit(g, p + n * 0.05f, -n);
            ASSERT_TRUE(near_vec(hit.position, p, 1e-5f));
            ASSERT_NEAR(hit.uv.x, u, 2e-5f);
            ASSERT_NEAR(hit.uv.y, v, 2e-5f);
            ASSERT_TRUE(near_vec(hit.ng, n, 1e-4f));
            ASSERT_TRUE(near_vec(hit.dpdu, du, 1e-4f));
            ASSERT_TRUE(near_vec(hit.dpdv, dv, 1e-4f));
        }
    }
}

TEST(GeometryHits, PatchUvsAndReversedNormals) {
    BilinearMesh m = patch({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0});
    m.uvs = {{0, 0}, {4, 0}, {0, 2}, {4, 2}};
    m.normals.assign(4, {0, 0, 2});
    ShapeDescription s = patches(m);
    s.reverse_orientation = true;
    const SurfaceHit hit = must_hit(Geometry{scene_of({s})}, {0.25f, 0.5f, 2}, {0, 0, -1});
    EXPECT_NEAR(hit.uv.x, 1, 1e-5f);
    EXPECT_NEAR(hit.uv.y, 1, 1e-5f);
    EXPECT_TRUE(near_vec(hit.dpdu, {0.25f, 0, 0}, 1e-5f));
    EXPECT_TRUE(near_vec(hit.dpdv, {0, 0.5f, 0}, 1e-5f));
    EXPECT_TRUE(near_vec(hit.ns, {0, 0, -1}, 1e-6f));
    EXPECT_TRUE(near_vec(hit.ng, {0, 0, -1}, 1e-6f));
}

TEST(GeometryHits, InterfacesAreSeenButDoNotOcclude) {
    for (int kind = 0; kind < 4; ++kind) {
        ShapeDescription s;
        if (kind == 0) s = mesh(unit_triangle(), AnimatedTransform(Transform::scale(4, 4, 1)));
        if (kind == 1) s = patches(patch({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 1}));
        if (kind == 2) s = shape(sphere(2));
        if (kind == 3)
            s = shape(sphere(2),
                      AnimatedTransform(Transform{}, 0, Transform::translate({0.1f, 0, 0}), 1));
        s.material = 0;
        s.inside = 0;
        SceneDescription scene = scene_of({s});
        scene.materials.push_back({"", InterfaceMaterial{}, {}});
        scene.media.push_back({});
        const Ray ray{{0.5f, 0.5f, 5}, {0, 0, -1}};
        SurfaceHit hit;
        EXPECT_TRUE(Geometry{scene}.intersect(ray, hit));
        EXPECT_FALSE(Geometry{scene}.occluded(ray));
        // An interface between nothing and nothing is not there.
        scene.shapes[0].inside = -1;
        EXPECT_FALSE(Geometry{scene}.intersect(ray, hit));
        scene.materials[0].value = DiffuseMaterial{};
        EXPECT_TRUE(Geometry{scene}.occluded(ray));
    }
}

TEST(GeometryHits, OccludedAgreesWithIntersect) {
    Random random(4);
    SceneDescription scene;
    for (int i = 0; i < 40; ++i) {
        const Transform t = Transform::translate(random.in_box(4)) *
                            Transform::rotate(360 * random.next(), random.direction());
        const Transform moved = Transform::translate(random.in_box(0.5f)) * t;
        const AnimatedTransform place =
            i % 2 ? AnimatedTransform(t) : AnimatedTransform(t, 0, moved, 1);
        if (i % 4 == 0) scene.shapes.push_back(mesh(unit_triangle(), place));
        if (i % 4 == 1) scene.shapes.push_back(shape(sphere(0.5f), place));
        if (i % 4 == 2) scene.shapes.push_back(shape(Disk{0, 1, 0.2f, 300}, place));
        if (i % 4 == 3)
            scene.shapes.push_back(
                patches(patch({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5f}), place));
    }
    const Geometry g{scene};
    int hits = 0;
    for (int i = 0; i < 50000; ++i) {
        const Ray ray{random.in_box(6), random.direction(), random.next(),
                      random.between(0.5f, 12)};
        SurfaceHit hit;
        const bool found = g.intersect(ray, hit);
        hits += found;
        ASSERT_EQ(found, g.occluded(ray));
        if (!found) continue;
        ASSERT_LE(hit.t, ray.t_max);
        ASSERT_TRUE(near_vec(hit.position, ray.origin + ray.direction * hit.t, 2e-5f));
        ASSERT_GT(dot(hit.ng, hit.ns), 0);
        const Bounds3 box = g.bounds();
        for (int k = 0; k < 3; ++k) {
            ASSERT_GE(hit.position[k], box.lo[k] - 1e-5f);
            ASSERT_LE(hit.position[k], box.hi[k] + 1e-5f);
        }
    }
    EXPECT_GT(hits, 3000);
}

TEST(GeometryHits, WorldTrianglesAreWhereRaysMeetThem) {
    const AnimatedTransform spin(Transform::translate({5, 0, 0}), 0,
                                 Transform::translate({5, 1, 0}) * Transform::rotate(90, {0, 0, 1}),
                                 1);
    const Geometry g{scene_of(
        {mesh(unit_triangle(), spin), patches(patch({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}))})};
    for (float time : {0.0f, 0.3f, 1.0f}) {
        const WorldTriangle t = g.world_triangle(0, 0, time);
        const Vec3 middle = (t.p0 + t.p1 + t.p2) / 3;
        const SurfaceHit hit = must_hit(g, middle + Vec3{0, 0, 1}, {0, 0, -1}, time);
        EXPECT_TRUE(near_vec(hit.position, middle, 2e-6f));
        EXPECT_NEAR(hit.barycentric.x, 1.0f / 3, 1e-5f);
        EXPECT_NEAR(hit.barycentric.y, 1.0f / 3, 1e-5f);
    }
    const WorldTriangle a = g.world_triangle(1, 0, 0), b = g.world_triangle(1, 1, 0);
    EXPECT_EQ(cross(a.p1 - a.p0, a.p2 - a.p0), (Vec3{0, 0, 1}));
    EXPECT_EQ(cross(b.p1 - b.p0, b.p2 - b.p0), (Vec3{0, 0, 1}));
}

}  // namespace
}  // namespace covtrace
