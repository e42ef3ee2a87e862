// Colours and further texture coordinates at the vertices of meshes.
#include <gtest/gtest.h>

#include "geometry_fixtures.h"
#include "light/lights.h"
#include "scene/vertex_colours.h"
#include "texture/spectra.h"
#include "texture_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// The unit triangle with colours, and a second set of coordinates: (s, t) = (2 y, 3 - x).
TriangleMesh coloured_triangle() {
    TriangleMesh m = unit_triangle();
    m.uvs = {{0, 0}, {1, 0}, {0, 1}};
    m.more_uvs = {{{0, 3}, {0, 2}, {2, 3}}};
    m.colours = {{{1, 0, 0}, 1}, {{0, 0.5f, 0}, 0.5f}, {{0, 0, 2}, 0}};
    return m;
}

/// The place in a triangle whose (u, v) is the given one, for the triangle above.
TexturePoint at(const TriangleMesh& mesh, float u, float v) {
    return {{u, v}, {u, v, 0}, {}, {}, {&mesh, 0, {u, v}}};
}

void expect_rgb(Rgb found, Rgb expected, float error = 1e-6f) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], error) << c;
}

TEST(VertexColours, AreLinearOverTriangles) {
    const TriangleMesh mesh = coloured_triangle();
    TextureScene scene;
    const TextureId colour = scene.add(VertexColourTexture{});
    const TextureId alpha = scene.add(VertexColourTexture{true}, false);
    const TextureId product = scene.add(ScaleTexture{scene.add_constant(Rgb(0.5f)), colour});
    const TextureId cut = scene.add(CutoffTexture{alpha, 0.6f}, false);
    const TextureStore store(scene.description);
    expect_rgb(store.eval(colour, at(mesh, 0.25f, 0.25f)), {0.5f, 0.125f, 0.5f});
    EXPECT_NEAR(store.eval_float(alpha, at(mesh, 0.25f, 0.25f)), 0.625f, 1e-6f);
    expect_rgb(store.eval(product, at(mesh, 0, 1)), {0, 0, 1});
    EXPECT_EQ(store.eval_float(cut, at(mesh, 0.25f, 0.25f)), 1);
    EXPECT_EQ(store.eval_float(cut, at(mesh, 0.5f, 0.25f)), 0);
    EXPECT_FALSE(store.is_constant(product));
    // Other shapes, and meshes without colours, have white ones.
    const TriangleMesh plain = unit_triangle();
    expect_rgb(store.eval(colour, {{0.2f, 0.2f}, {}}), Rgb(1));
    expect_rgb(store.eval(colour, at(plain, 0.2f, 0.2f)), Rgb(1));
}

TEST(VertexColours, OtherSetsOfCoordinatesAreFollowed) {
    const TriangleMesh mesh = coloured_triangle();
    BilerpTexture ramp;  // s + 10 t
    ramp.v10 = Rgb(1), ramp.v01 = Rgb(10), ramp.v11 = Rgb(11);
    ramp.mapping.uv_set = 0;
    TextureScene scene;
    const TextureId second = scene.add(ramp);
    ramp.mapping.uv_set = 7;  // the mesh has no such set: its (u, v) are taken
    const TextureId missing = scene.add(ramp);
    const TextureStore store(scene.description);
    const TexturePoint place = at(mesh, 0.25f, 0.5f);
    EXPECT_NEAR(store.eval(second, place).g, 1 + 10 * 2.75f, 1e-5f);
    EXPECT_NEAR(store.eval(missing, place).g, 0.25f + 10 * 0.5f, 1e-5f);
    // The slopes by (u, v) are ds = 2 dv and dt = -du, over 2 pi times the value.
    const TextureSpectra spectra(store);
    const SpatialCovariance2 c = spectra.uv_covariance(second, place, {1, 0, 0}, {0, 1, 0}, 1e-4f);
    const float unit = 1 / (2 * kPi * 28.5f);
    EXPECT_NEAR(c.ss, sqr(-10 * unit), 5e-3f * c.ss);
    EXPECT_NEAR(c.st, -10 * unit * 2 * unit, 5e-3f * c.ss);
    EXPECT_NEAR(c.tt, sqr(2 * unit), 1e-3f * c.ss);
}

TEST(VertexColours, VaryAsFastAsTheyRise) {
    TriangleMesh mesh = coloured_triangle();
    mesh.colours = {{Rgb(0.5f)}, {Rgb(0.8f)}, {Rgb(0.5f)}};
    TextureScene scene;
    const TextureId id = scene.add(VertexColourTexture{});
    const TextureStore store(scene.description);
    const TextureSpectra spectra(store);
    const auto covariance = [&] {
        return spectra.uv_covariance(id, at(mesh, 0.5f, 0.25f), {1, 0, 0}, {0, 1, 0}, 1e-4f);
    };
    const SpatialCovariance2 c = covariance();
    EXPECT_NEAR(c.ss, sqr(0.3f / (2 * kPi * 0.65f)), 1e-2f * c.ss);
    EXPECT_NEAR(c.st, 0, 1e-6f);
    EXPECT_NEAR(c.tt, 0, 1e-6f);
    // Coordinates that run twice as fast see half of the slope.
    mesh.uvs = {{0, 0}, {2, 0}, {0, 1}};
    EXPECT_NEAR(covariance().ss, c.ss / 4, 1e-3f * c.ss);
    // Where all vertices have the same coordinates nothing is known, and nothing not finite.
    mesh.uvs = {{1, 1}, {1, 1}, {1, 1}};
    EXPECT_EQ(covariance().ss, 0);
}

TEST(VertexColours, StepsBetweenTrianglesAreEdges) {
    // A square of two triangles that share places, but no vertex: a white one and a black one, and
    // beside them a third one of the white one's colour.
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0},
                      {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
    mesh.colours.assign(9, {Rgb(0.9f)});
    for (size_t i = 3; i < 6; ++i) mesh.colours[i] = {Rgb(0.1f)};
    find_colour_steps(mesh);
    const auto step = uint8_t(std::lround(255 * 0.8f));
    EXPECT_EQ(mesh.colour_steps,
              (std::vector<std::array<uint8_t, 3>>{{0, step, 0}, {0, 0, step}, {0, 0, 0}}));
    TextureScene scene;
    const TextureId id = scene.add(VertexColourTexture{});
    const TextureStore store(scene.description);
    const TextureSpectra spectra(store);
    // The triangle has pbrt's coordinates; the side is where the second corner's weight is 0.
    const auto near_side = [&](float distance) {
        const Vec2 b{distance, 0.5f};
        return spectra.uv_covariance(id, {{b.x + b.y, b.y}, {}, {}, {}, {&mesh, 0, b}}, {}, {},
                                     1e-4f);
    };
    for (const float distance : {0.1f, 0.01f}) {
        const float edge = 1 / sqr(kPi * distance);
        EXPECT_NEAR(near_side(distance).ss, edge, 1e-3f * edge);
        EXPECT_NEAR(near_side(distance).st, -edge, 1e-3f * edge);
        EXPECT_NEAR(near_side(distance).tt, edge, 1e-3f * edge);
    }
    // Equal colours have no steps.
    mesh.colours.assign(9, {Rgb(0.9f)});
    find_colour_steps(mesh);
    EXPECT_EQ(near_side(0.01f).ss, 0);
}

TEST(VertexColours, ComeWithHitsOfMovingAndInstancedMeshes) {
    SceneDescription scene;
    const AnimatedTransform motion(Transform(), 0, Transform::translate({2, 0, 0}), 1);
    scene.camera.shutter_close = 1;
    scene.shapes.push_back(mesh(coloured_triangle(), motion));
    scene.shapes.push_back(
        mesh(unit_triangle(), AnimatedTransform(Transform::translate({0, 0, -5}))));
    scene.objects.push_back(
        {"o", {mesh(coloured_triangle(), AnimatedTransform(Transform::translate({10, 0, 0})))}});
    scene.instances.push_back({0, AnimatedTransform(Transform::scale(2, 2, 2)), {}});
    scene.instances.push_back(
        {0, AnimatedTransform(Transform(), 0, Transform::translate({0, 4, 0}), 1), {}});
    TextureScene textures;
    const TextureId id = textures.add(VertexColourTexture{});
    const TextureStore store(textures.description);
    const Geometry geometry(scene);
    const auto colour = [&](Vec3 origin, float time) {
        SurfaceHit hit;
        EXPECT_TRUE(geometry.intersect({origin, {0, 0, -1}, time}, hit));
        return store.eval(id, {hit.uv, hit.position, {}, hit.ng, hit.vertices()});
    };
    const Rgb expected{0.5f, 0.125f, 0.5f};
    expect_rgb(colour({0.25f, 0.25f, 1}, 0), expected, 1e-4f);
    expect_rgb(colour({1.25f, 0.25f, 1}, 0.5f), expected, 1e-4f);
    expect_rgb(colour({20.5f, 0.5f, 1}, 0), expected, 1e-4f);
    expect_rgb(colour({10.25f, 2.25f, 1}, 0.5f), expected, 1e-4f);
    expect_rgb(colour({0.25f, 0.25f, -1}, 0), Rgb(1));
}

TEST(VertexColours, LightsShineInThem) {
    TextureScene scene;
    AreaLightDescription light;
    light.image = scene.add(VertexColourTexture{});
    scene.description.area_lights.push_back(light);
    scene.description.shapes.push_back(mesh(coloured_triangle()));
    scene.description.shapes[0].area_light = 0;
    scene.description.shapes[0].alpha = scene.add(VertexColourTexture{true}, false);
    const TextureStore store(scene.description);
    Geometry geometry(scene.description);
    const Lights lights(scene.description, geometry, &store);
    Random random(5);
    const Vec3 p{0.3f, 0.3f, 2};
    for (int i = 0; i < 100; ++i) {
        const auto sample = lights.finish_draw(p, {}, 0, random.next(),
                                               lights.begin_draw({random.next(), random.next()}));
        ASSERT_TRUE(sample);
        SurfaceHit hit;
        ASSERT_TRUE(geometry.intersect({p, sample->wi}, hit));
        const Rgb seen = lights.emitted(hit, -sample->wi);
        const float x = hit.position.x, y = hit.position.y, alpha = 1 - 0.5f * x - y;
        expect_rgb(seen, {1 - x - y, 0.5f * x, 2 * y}, 1e-4f);
        expect_rgb(sample->radiance, seen * alpha, 1e-4f);
    }
}

TEST(VertexColours, AlphaLetsRaysPass) {
    TextureScene scene;
    TriangleMesh cut = coloured_triangle();
    scene.description.shapes.push_back(mesh(cut));
    scene.description.shapes[0].alpha =
        scene.add(CutoffTexture{scene.add(VertexColourTexture{true}, false), 0.5f}, false);
    const TextureStore store(scene.description);
    Geometry geometry(scene.description);
    geometry.set_alpha([&](TextureId id, const AlphaPlace& at) {
        return store.eval_float(id, {at.uv, at.position, {}, {}, at.vertices});
    });
    SurfaceHit hit;
    EXPECT_TRUE(geometry.intersect({{0.2f, 0.3f, 1}, {0, 0, -1}}, hit));
    EXPECT_FALSE(geometry.intersect({{0.2f, 0.45f, 1}, {0, 0, -1}}, hit));
    EXPECT_TRUE(geometry.occluded({{0.2f, 0.3f, 1}, {0, 0, -1}}));
    EXPECT_FALSE(geometry.occluded({{0.2f, 0.45f, 1}, {0, 0, -1}}));
}

}  // namespace
}  // namespace covtrace
