// Many rays at once: each gets the bits of a single ray, whichever others are with it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "geometry/placed_scene.h"
#include "geometry_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

constexpr int kSide = 12;  // squares along a side of a floor

Vec3 corner(int x, int y) {
    const float u = float(x) / kSide - 0.5f, v = float(y) / kSide - 0.5f;
    return {2 * u, 2 * v, 0.37f * u + 0.11f * v};
}

/// A floor of triangles; `turned` cuts its squares along the other diagonal.
TriangleMesh floor_of_triangles(bool turned) {
    TriangleMesh m;
    for (int y = 0; y <= kSide; ++y)
        for (int x = 0; x <= kSide; ++x) m.positions.push_back(corner(x, y));
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) {
            const uint32_t a = y * (kSide + 1) + x, b = a + 1, c = a + kSide + 2, d = a + kSide + 1;
            if (turned)
                m.triangles.insert(m.triangles.end(), {{a, b, d}, {b, c, d}});
            else
                m.triangles.insert(m.triangles.end(), {{a, b, c}, {a, c, d}});
        }
    return m;
}

BilinearMesh floor_of_patches() {
    BilinearMesh m;
    for (int y = 0; y <= kSide; ++y)
        for (int x = 0; x <= kSide; ++x) m.positions.push_back(corner(x, y));
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) {
            const uint32_t a = y * (kSide + 1) + x;
            m.patches.push_back({a, a + 1, a + kSide + 1, a + kSide + 2});
        }
    return m;
}

/// A ray towards a corner of a square, a point of its side, or somewhere in it: edges are where two
/// surfaces are hit at one distance, or one is just missed.
Ray ray_to_floor(Random& random, int i) {
    const int x = int(random.next() * kSide), y = int(random.next() * kSide);
    const float along = random.next(), across = random.next();
    Vec3 target = corner(x, y);
    if (i % 4 != 0) target = target + (corner(x + 1, y) - target) * along;
    if (i % 4 == 2) target = target + (corner(x, y + 1) - corner(x, y)) * along;
    if (i % 4 == 3) target = target + (corner(x, y + 1) - corner(x, y)) * across;
    const Vec3 origin = i % 3 == 0 ? target + Vec3{0, 0, 2} : random.in_box(3);
    const Vec3 way = target - origin;
    const float reach = i % 2 ? kInfinity : length(way) * (1 + 1e-5f);
    return {origin, normalize(way), random.next(), reach};
}

bool same_bits(const SurfaceHit& a, const SurfaceHit& b) {
    const auto same = [](const auto& x, const auto& y) {
        return std::memcmp(&x, &y, sizeof(x)) == 0;
    };
    return same(a.t, b.t) && same(a.position, b.position) &&
           same(a.position_error, b.position_error) && same(a.ng, b.ng) && same(a.ns, b.ns) &&
           same(a.dpdu, b.dpdu) && same(a.dpdv, b.dpdv) && same(a.uv, b.uv) &&
           same(a.time, b.time) && a.shape == b.shape && a.primitive == b.primitive &&
           a.instance == b.instance && same(a.barycentric, b.barycentric) && a.mesh == b.mesh;
}

/// Holds rays in groups of all sizes up to `most` against single rays; returns the number of hits.
int expect_bits_of_single_rays(const Geometry& g, size_t most) {
    Random random(7);
    std::vector<Ray> rays(20000);
    for (size_t i = 0; i < rays.size(); ++i) rays[i] = ray_to_floor(random, int(i));
    int hits = 0;
    size_t size = 1;
    for (size_t first = 0; first < rays.size(); first += size, size = size % most + 1) {
        const size_t count = std::min(size, rays.size() - first);
        std::vector<SurfaceHit> near(count), seen(count);
        std::vector<HitQuery> nearest, from_camera;
        std::vector<OcclusionQuery> shadows;
        for (size_t k = 0; k < count; ++k) {
            nearest.push_back({&rays[first + k], &near[k]});
            from_camera.push_back({&rays[first + k], &seen[k]});
            shadows.push_back({&rays[first + k]});
        }
        g.intersect(nearest);
        g.intersect_seen(from_camera);
        g.occluded(shadows);
        for (size_t k = 0; k < count; ++k) {
            const Ray& ray = rays[first + k];
            SurfaceHit hit;
            const bool found = g.intersect(ray, hit);
            hits += found;
            EXPECT_EQ(nearest[k].found, found);
            EXPECT_TRUE(!found || same_bits(near[k], hit)) << "ray " << first + k;
            const bool is_seen = g.intersect_seen(ray, hit);
            EXPECT_EQ(from_camera[k].found, is_seen);
            EXPECT_TRUE(!is_seen || same_bits(seen[k], hit)) << "ray " << first + k;
            EXPECT_EQ(shadows[k].occluded, g.occluded(ray)) << "ray " << first + k;
        }
    }
    return hits;
}

/// Floors on top of one another, and pieces with edges that have no neighbour.
SceneDescription floors(const AnimatedTransform& place = {}) {
    SceneDescription scene =
        scene_of({mesh(floor_of_triangles(false), place), mesh(floor_of_triangles(true), place),
                  patches(floor_of_patches(), place)});
    Random random(3);
    for (int i = 0; i < 40; ++i) {
        const Vec3 a = corner(i % kSide, i * 7 % kSide) + Vec3{0, 0, 0.1f + 0.02f * float(i)};
        const Vec3 u = corner(1, 0) - corner(0, 0), v = corner(0, 1) - corner(0, 0);
        if (i % 2)
            scene.shapes.push_back(patches(patch(a, a + u, a + v, a + u + v), place));
        else
            scene.shapes.push_back(
                mesh({.positions = {a, a + u, a + v}, .triangles = {{0, 1, 2}}}, place));
    }
    scene.camera.shutter_close = 1;
    return scene;
}

/// For each instruction set that this processor has.
class RayPackets : public testing::TestWithParam<std::string> {
  protected:
    void SetUp() override {
        if ((GetParam() == "avx512" && !__builtin_cpu_supports("avx512vl")) ||
            (GetParam() == "avx2" && !__builtin_cpu_supports("avx2")))
            GTEST_SKIP() << "no " << GetParam();
    }
};

TEST_P(RayPackets, GiveTheBitsOfSingleRays) {
    const Geometry g{floors(), GetParam()};
    EXPECT_EQ(g.impl().packets_are_exact, GetParam() != "sse2");
    EXPECT_GT(expect_bits_of_single_rays(g, 21), 10000);
}

TEST_P(RayPackets, GiveTheBitsOfSingleRaysInMotion) {
    const Geometry g{floors(AnimatedTransform({}, 0, Transform::translate({0.1f, 0, 0}), 1)),
                     GetParam()};
    EXPECT_GT(expect_bits_of_single_rays(g, 21), 10000);
}

TEST_P(RayPackets, GiveTheBitsOfSingleRaysOnQuadrics) {
    SceneDescription scene = floors();
    for (int i = 0; i < 3; ++i) scene.shapes.push_back(shape(Disk{0, 1, 0, 360}));
    scene.shapes.push_back(shape(sphere(0.5f)));
    scene.shapes.push_back(patches(patch({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5f})));
    EXPECT_GT(expect_bits_of_single_rays(Geometry{scene, GetParam()}, 21), 10000);
}

TEST_P(RayPackets, GiveTheBitsOfSingleRaysThroughAlpha) {
    SceneDescription scene = floors();
    TextureDescription half;
    half.is_spectrum = false;
    half.value = ConstantTexture{Rgb(0.5f)};
    scene.textures = {half};
    for (size_t i = 0; i < scene.shapes.size(); i += 2) scene.shapes[i].alpha = 0;
    Geometry g{scene, GetParam()};
    g.set_alpha([](TextureId, const AlphaPlace&) { return 0.5f; });
    EXPECT_GT(expect_bits_of_single_rays(g, 21), 10000);
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, RayPackets,
                         testing::Values("sse2", "avx", "avx2", "avx512"));

TEST(RaysTogether, CamerasDoNotSeeThePlaneThatTheyStandOn) {
    const Geometry g{floors()};
    SurfaceHit hits[2];
    const Vec3 eye = (corner(3, 3) + corner(4, 4)) / 2;
    const Ray rays[2] = {{eye, normalize(corner(9, 4) - eye)}, {eye + Vec3{0, 0, 2}, {0, 0, -1}}};
    HitQuery queries[2] = {{&rays[0], &hits[0]}, {&rays[1], &hits[1]}};
    g.intersect_seen(queries);
    SurfaceHit single;
    EXPECT_EQ(queries[0].found, g.intersect_seen(rays[0], single));
    EXPECT_TRUE(queries[1].found);
}

TEST(RaysTogether, RaysThatCannotBeFollowedMeetNothing) {
    const Geometry g{floors()};
    const float bad = std::numeric_limits<float>::quiet_NaN();
    const Ray rays[3] = {
        {{bad, 0, 2}, {0, 0, -1}}, {{0.1f, 0.1f, 2}, {0, 0, -1}}, {{0, 0, 2}, {0, bad, 1}}};
    SurfaceHit hits[3];
    HitQuery nearest[3];
    OcclusionQuery shadows[3];
    for (size_t k = 0; k < 3; ++k) nearest[k] = {&rays[k], &hits[k]}, shadows[k] = {&rays[k]};
    g.intersect(nearest);
    g.occluded(shadows);
    for (size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(nearest[k].found, k == 1);
        EXPECT_EQ(shadows[k].occluded, k == 1);
    }
}

}  // namespace
}  // namespace covtrace
