// Alpha: the rays that pass a surface with holes, and its image in the voxel grid and the query of
// occluders.
#include <gtest/gtest.h>

#include <optional>

#include "geometry_fixtures.h"
#include "occluders/query.h"
#include "occluders/voxel_grid.h"

namespace covtrace::test {
namespace {

constexpr float kHalf = 1.0f;

/// A square of side 2 in the plane z, with (u, v) over it.
TriangleMesh square(float z) {
    TriangleMesh m;
    m.positions = {{-kHalf, -kHalf, z}, {kHalf, -kHalf, z}, {kHalf, kHalf, z}, {-kHalf, kHalf, z}};
    m.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    m.triangles = {{0, 1, 2}, {0, 2, 3}};
    return m;
}

TextureDescription texture(float value) {
    TextureDescription t;
    t.is_spectrum = false;
    t.value = ConstantTexture{Rgb(value)};
    return t;
}

/// Squares at z = 0, 1, 2 …; all with alpha but the last one.
SceneDescription pile(int with_alpha) {
    std::vector<ShapeDescription> shapes;
    for (int i = 0; i <= with_alpha; ++i) {
        shapes.push_back(mesh(square(float(i))));
        if (i < with_alpha) shapes.back().alpha = 0;
    }
    SceneDescription scene = scene_of(std::move(shapes));
    scene.textures = {texture(0.5f)};
    return scene;
}

TEST(GeometryAlpha, HolesLetRaysThroughToWhatLiesBehind) {
    Geometry g(pile(3));
    g.set_alpha([](TextureId, const AlphaPlace& at) { return at.uv.x < 0.5f ? 1.0f : 0.0f; });
    SurfaceHit hit;
    ASSERT_TRUE(g.intersect({{-0.5f, 0.2f, -1}, {0, 0, 1}}, hit));
    EXPECT_EQ(hit.shape, 0u);
    EXPECT_NEAR(hit.t, 1, 1e-6f);
    ASSERT_TRUE(g.intersect({{0.5f, 0.2f, -1}, {0, 0, 1}}, hit));
    EXPECT_EQ(hit.shape, 3u);
    EXPECT_NEAR(hit.t, 4, 1e-5f) << "the distance is from the ray's own origin";
    EXPECT_TRUE(g.occluded({{-0.5f, 0.2f, -1}, {0, 0, 1}, 0, 1.5f}));
    EXPECT_FALSE(g.occluded({{0.5f, 0.2f, -1}, {0, 0, 1}, 0, 3.9f}));
    EXPECT_TRUE(g.occluded({{0.5f, 0.2f, -1}, {0, 0, 1}, 0, 4.1f}));
}

/// Two walls at z = 0 and 1 whose fronts are away from each other.
TriangleMesh two_walls() {
    TriangleMesh m = square(0);
    for (auto& t : m.triangles) std::swap(t[1], t[2]);
    const TriangleMesh upper = square(1);
    m.positions.insert(m.positions.end(), upper.positions.begin(), upper.positions.end());
    m.uvs.insert(m.uvs.end(), upper.uvs.begin(), upper.uvs.end());
    for (auto t : upper.triangles) m.triangles.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
    return m;
}

TEST(GeometryAlpha, TubesForRibbonsAreLeftFreelyWhereTheyAreTranslucent) {
    const auto first_wall = [](const Geometry& g, float from, float direction) {
        const Ray ray{{0.5f, 0.2f, from}, {0, 0, direction}};
        SurfaceHit hit, packet_hit;
        HitQuery queries[2] = {{&ray, &packet_hit, false}, {&ray, &packet_hit, false}};
        g.intersect(queries);
        const bool found = g.intersect(ray, hit);
        EXPECT_EQ(g.occluded(ray), found);
        EXPECT_EQ(queries[1].found, found);
        return found ? std::optional(hit.position.z) : std::nullopt;
    };
    enum class Tube { translucent, opaque, glass_in_places, filled, shining };
    for (const bool is_reversed : {false, true})
        for (const float mirrored : {1.0f, -1.0f})
            for (const Tube kind : {Tube::translucent, Tube::opaque, Tube::glass_in_places,
                                    Tube::filled, Tube::shining}) {
                const bool is_left_freely = kind == Tube::translucent;
                ShapeDescription tube =
                    mesh(two_walls(), AnimatedTransform(Transform::scale(mirrored, 1, 1)));
                tube.reverse_orientation = is_reversed;
                tube.tube_sides = 4;
                tube.material = 2;
                if (kind == Tube::filled) tube.inside = 0;
                if (kind == Tube::shining) tube.area_light = 0;
                SceneDescription scene = scene_of({tube});
                scene.materials.resize(3);
                scene.media.resize(1);
                scene.area_lights.resize(1);
                if (kind != Tube::opaque) scene.materials[0].value = DiffuseTransmissionMaterial{};
                if (kind == Tube::glass_in_places) scene.materials[1].value = DielectricMaterial{};
                scene.materials[2].mix = MaterialMix{{0, 1}, 0};
                const Geometry g(scene);
                EXPECT_EQ(first_wall(g, 3, -1), 1.0f);
                EXPECT_EQ(first_wall(g, -3, 1), 0.0f);
                const auto up = first_wall(g, 0.5f, 1), down = first_wall(g, 0.5f, -1);
                EXPECT_EQ(up, is_left_freely ? std::nullopt : std::optional(1.0f));
                EXPECT_EQ(down, is_left_freely ? std::nullopt : std::optional(0.0f));
            }
}

TEST(GeometryAlpha, CountsOnWhatMayBeAnInterfaceToo) {
    SceneDescription scene = pile(1);
    scene.materials.resize(3);
    scene.materials[1].value = InterfaceMaterial{};
    scene.materials[2].mix = MaterialMix{{0, 1}, 0};
    scene.shapes[0].material = 2;
    Geometry g(scene);
    g.set_alpha([](TextureId, const AlphaPlace&) { return 0.0f; });
    SurfaceHit hit;
    ASSERT_TRUE(g.intersect({{0.5f, 0.2f, -1}, {0, 0, 1}}, hit));
    EXPECT_EQ(hit.shape, 1u);
    EXPECT_TRUE(g.has_interfaces());
}

// The question whether a mix may be no surface must not walk all of its 2^100 ends.
TEST(GeometryAlpha, MixesThatMixTheSameTwiceEach) {
    SceneDescription scene = pile(0);
    scene.materials.resize(101);
    scene.materials[0].value = InterfaceMaterial{};
    for (MaterialId i = 1; i <= 100; ++i)
        scene.materials[size_t(i)].mix = MaterialMix{{i - 1, i - 1}, 0};
    scene.shapes[0].material = 100;
    EXPECT_TRUE(Geometry(scene).has_interfaces());
}

TEST(GeometryAlpha, WithoutALookupEverythingIsOpaque) {
    const Geometry g(pile(1));
    SurfaceHit hit;
    ASSERT_TRUE(g.intersect({{0.5f, 0.2f, -1}, {0, 0, 1}}, hit));
    EXPECT_EQ(hit.shape, 0u);
}

// The count is binomial, 20000 rays: five standard deviations (false alarm 6e-7 each).
TEST(GeometryAlpha, PartialAlphaStopsItsShareOfRaysAndTheSameOnesEachTime) {
    for (const float opacity : {0.1f, 0.5f, 0.8f}) {
        Geometry g(pile(2));
        g.set_alpha([opacity](TextureId, const AlphaPlace&) { return opacity; });
        Random random(3);
        constexpr int kRays = 20000;
        int count[3] = {}, blocked = 0;
        for (int i = 0; i < kRays; ++i) {
            const Ray ray{{random.between(-0.9f, 0.9f), random.between(-0.9f, 0.9f), -1},
                          {0, 0, 1},
                          random.next()};
            SurfaceHit hit, again;
            ASSERT_TRUE(g.intersect(ray, hit));
            ASSERT_TRUE(g.intersect(ray, again));
            EXPECT_EQ(hit.shape, again.shape);
            ++count[hit.shape];
            Ray short_ray = ray;
            short_ray.t_max = 2.5f;
            blocked += g.occluded(short_ray);
        }
        const auto expect_share = [](int n, double p) {
            EXPECT_NEAR(n, kRays * p, 5 * std::sqrt(kRays * p * (1 - p)));
        };
        const double a = opacity;
        expect_share(count[0], a);
        expect_share(count[1], (1 - a) * a);
        expect_share(count[2], (1 - a) * (1 - a));
        expect_share(blocked, 1 - (1 - a) * (1 - a));
    }
}

// The same interval as above.
TEST(GeometryAlpha, PartialAlphaIsDrawnForEachSample) {
    Geometry g(pile(1));
    g.set_alpha([](TextureId, const AlphaPlace&) { return 0.5f; });
    constexpr int kRays = 20000;
    int stopped = 0;
    for (int i = 0; i < kRays; ++i) {
        Ray ray{{0.1f, 0.2f, -1}, {0, 0, 1}};
        ray.sample = uint32_t(i);
        SurfaceHit hit;
        ASSERT_TRUE(g.intersect(ray, hit));
        EXPECT_EQ(hit.sample, ray.sample);
        stopped += hit.shape == 0;
    }
    EXPECT_NEAR(stopped, kRays / 2, 5 * std::sqrt(kRays / 4));
}

TEST(GeometryAlpha, CurvedAndInstancedShapesHaveItToo) {
    SceneDescription scene;
    scene.textures = {texture(0.5f)};
    ShapeDescription ball = shape(sphere(1));
    ball.alpha = 0;
    ObjectDescription object;
    object.shapes = {ball};
    scene.objects = {object};
    scene.instances.push_back({0, AnimatedTransform(Transform::translate({5, 0, 0})), {}});
    ball.object_to_world = AnimatedTransform(Transform::translate({-5, 0, 0}), 0,
                                             Transform::translate({-5, 0, 0.5f}), 1);
    scene.shapes = {ball};
    Geometry g(scene);
    for (const float x : {-5.0f, 5.0f}) {
        SurfaceHit hit;
        const Ray ray{{x, 0.3f, -9}, {0, 0, 1}, 0.5f};
        g.set_alpha([](TextureId, const AlphaPlace&) { return 1.0f; });
        EXPECT_TRUE(g.intersect(ray, hit)) << x;
        EXPECT_TRUE(g.occluded(ray)) << x;
        // The half that is turned to the ray is a hole; the far one is met from inside.
        g.set_alpha(
            [](TextureId, const AlphaPlace& at) { return at.position.z > 0.3f ? 1.0f : 0.0f; });
        ASSERT_TRUE(g.intersect(ray, hit)) << x;
        EXPECT_GT(hit.position.z, 0.3f);
        EXPECT_GT(dot(hit.ng, ray.direction), 0);
        g.set_alpha([](TextureId, const AlphaPlace&) { return 0.0f; });
        EXPECT_FALSE(g.intersect(ray, hit)) << x;
        EXPECT_FALSE(g.occluded(ray)) << x;
    }
}

/// Voxels that a march along x at height y, in the plane of the pile's first square, meets.
int voxels_along(const VoxelGrid& grid, float y) {
    VoxelMarch march(grid, {-2, y, 0}, {2, y, 0});
    OccluderEvent e;
    int count = 0;
    while (march.next(1.5f * grid.voxel_size(), e)) ++count;
    return count;
}

TEST(GeometryAlpha, TheVoxelGridHasTheHoles) {
    SceneDescription scene = pile(1);
    scene.shapes.resize(1);
    Geometry whole(scene), cut(scene);
    // The surface is opaque below v = 1/2 only.
    cut.set_alpha([](TextureId, const AlphaPlace& at) { return at.uv.y < 0.5f ? 1.0f : 0.0f; });
    VoxelGridOptions options;
    options.width = 40;
    options.box = {{-2, -2, -2}, {2, 2, 2}};
    const VoxelGrid all(whole, options), half(cut, options);
    EXPECT_GT(voxels_along(all, -0.5f), 0);
    EXPECT_GT(voxels_along(all, 0.5f), 0);
    EXPECT_GT(voxels_along(half, -0.5f), 0);
    EXPECT_EQ(voxels_along(half, 0.5f), 0);
}

TEST(GeometryAlpha, HolesHaveOutlinesAndSquaresBehindThemNone) {
    SceneDescription scene = scene_of({mesh(square(0))});
    scene.shapes[0].alpha = 0;
    scene.textures = {texture(0.5f)};
    Geometry g(scene);
    // The surface is opaque for x below 0 only; a veil of a tenth elsewhere counts as nothing.
    g.set_alpha([](TextureId, const AlphaPlace& at) { return at.uv.x < 0.5f ? 1.0f : 0.1f; });
    const OccluderQuery query(g);
    EdgeMeasure nearest;
    nearest.b = 1;
    nearest.widest = 0.3f;
    const auto beside = [&](float x) {
        return query({{x, 0.1f, 2}, {x, 0.1f, -2}, 0, {}, {}}, nearest, 1e-4f);
    };
    // One piece of 64 is 1/32 wide and half of the pieces are cut along their diagonal.
    for (const float gap : {0.05f, 0.2f}) {
        const OutlineEvents found = beside(gap);
        ASSERT_GT(found.count, 0u);
        float least = kInfinity;
        for (size_t i = 0; i < found.count; ++i) least = std::min(least, found.events[i].distance);
        EXPECT_NEAR(least, gap, 1.0f / 32 + 1e-4f);
    }
    EXPECT_EQ(beside(0.98f).count, 0u) << "the square's own border is not there";
    EXPECT_EQ(beside(-0.5f).count, 0u) << "nor are the borders of pieces";
    EXPECT_GT(beside(-0.98f).count, 0u);
}

TEST(GeometryAlpha, OpaqueTrianglesBesideEachOtherHaveNoOutlineBetweenThem) {
    // Two halves of a parallelogram, with the edge between them reversed, and so many triangles
    // without area that pieces are a 32nd or an 8th of an edge: 63 and 10 would not be too many.
    for (const auto& [triangles, per_edge] : {std::pair{489u, 32u}, {18000u, 8u}}) {
        TriangleMesh m;
        m.positions = {{0.1f, 0.3f, 0.7f}, {1.4f, 0.6f, 0.9f}, {0.4f, 1.7f, 1.1f}, {1.7f, 2, 1.3f}};
        m.triangles.assign(triangles, {0, 0, 0});
        m.triangles[0] = {0, 1, 2};
        m.triangles[1] = {2, 1, 3};
        SceneDescription scene = scene_of({mesh(m)});
        scene.shapes[0].alpha = 0;
        scene.textures = {texture(0.5f)};
        Geometry g(scene);
        g.set_alpha([](TextureId, const AlphaPlace&) { return 1.0f; });
        EXPECT_EQ(OccluderQuery(g).edges(), 4 * per_edge);
    }
}

}  // namespace
}  // namespace covtrace::test
