// Rays to sampled lamps end before the lamps' own surfaces, however far from the scene's origin.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/rng.h"
#include "integrator/visibility.h"
#include "light_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// A tube of radius 0.5 about the z axis, with this many flat sides.
TriangleMesh tube(uint32_t sides) {
    TriangleMesh m;
    for (uint32_t i = 0; i < sides; ++i) {
        const float angle = 2 * kPi * float(i) / float(sides);
        for (const float z : {-0.6f, 0.6f})
            m.positions.push_back({0.5f * std::cos(angle), 0.5f * std::sin(angle), z});
        const uint32_t a = 2 * i, b = 2 * ((i + 1) % sides);
        m.triangles.push_back({a, b, b + 1});
        m.triangles.push_back({a, b + 1, a + 1});
    }
    return m;
}

struct Lamp {
    std::string name;
    ShapeDescription shape;
};

/// Lamps about a unit in size about the origin, none of which hides any part of itself.
std::vector<Lamp> convex_lamps() {
    const auto turned = [](const Transform& t) {
        return AnimatedTransform(Transform::rotate(37, {1, 2, 3}) * t);
    };
    BilinearMesh patch;
    patch.positions = {{-0.5f, -0.4f, 0}, {0.6f, -0.5f, 0}, {-0.5f, 0.5f, 0}, {0.6f, 0.4f, 0}};
    patch.patches = {{0, 1, 2, 3}};
    return {
        {"sphere", shape_of(whole_sphere(0.5f), turned({}))},
        {"nearly even sphere",
         shape_of(whole_sphere(0.5f), turned(Transform::scale(1, 1.00008, 1)))},
        {"part of a sphere", shape_of(Sphere{0.5f, -0.5f, 0.1f, 300}, turned({}))},
        {"ellipsoid", shape_of(whole_sphere(0.5f), turned(Transform::scale(1, 0.6, 1.2)))},
        {"disk", shape_of(Disk{0.1f, 0.5f, 0.1f, 360}, turned({}))},
        {"triangles", mesh_of(rectangle(1, 0.7f), turned({}))},
        {"patch", shape_of(std::make_shared<const BilinearMesh>(patch), turned({}))},
        {"tube", mesh_of(tube(12), turned({}))},
    };
}

constexpr TextureId kWindow = 0, kLamp = 1;

/// A pile of windows before a lamp, which alpha hides where they are looked at. A ray starts anew
/// behind each one. The lamp has an alpha, too, so that it is looked for among them.
void add_hidden_windows(LightScene& scene, Vec3 center) {
    BilerpTexture opacity;
    opacity.v00 = Rgb(0), opacity.v10 = Rgb(1), opacity.v01 = Rgb(0), opacity.v11 = Rgb(1);
    for (const char* name : {"window", "lamp"})
        scene.description.textures.push_back({name, true, opacity, {}});
    scene.description.shapes.front().alpha = kLamp;
    for (int i = 0; i < 30; ++i) {
        const Vec3 middle = center + Vec3{0, 0, 1.1f + 0.03f * float(i)};
        ShapeDescription window =
            mesh_of(rectangle(50, 50),
                    placed({Transform::translate(middle), Transform::rotate(10, {1, 0, 0})}));
        window.alpha = kWindow;
        scene.description.shapes.push_back(window);
    }
}

struct Case {
    std::string name;
    float far = 0;  ///< about how far from the origin
    bool moves = false;
    bool has_windows = false;
};
void PrintTo(const Case& c, std::ostream* out) {
    *out << c.name;
}

class Aim : public testing::TestWithParam<Case> {};

TEST_P(Aim, NoLampHidesItself) {
    const Vec3 center = Vec3{1, 0.7f, -0.9f} * GetParam().far;
    for (Lamp& lamp : convex_lamps()) {
        const Transform place = Transform::translate(center) * lamp.shape.object_to_world.start();
        lamp.shape.object_to_world = AnimatedTransform(place);
        if (GetParam().moves) {
            const Transform end = Transform::translate(center + Vec3{0.3f, 0, 0.1f}) *
                                  Transform::rotate(20, {1, 1, 0}) *
                                  Transform::translate(center * -1) * place;
            lamp.shape.object_to_world = AnimatedTransform(place, 0, end, 1);
        }
        LightScene scene;
        scene.description.camera.shutter_open = 0;
        scene.description.camera.shutter_close = 1;
        scene.add(lamp.shape, Rgb(1));
        if (GetParam().has_windows) add_hidden_windows(scene, center);
        scene.build();
        scene.geometry->set_alpha(
            [](TextureId texture, const AlphaPlace&) { return texture == kLamp ? 1.0f : 0.0f; });
        Rng rng(7);
        int found = 0, hidden = 0;
        for (int i = 0; i < 20000; ++i) {
            // Places all around, among them many that see the lamp at a grazing angle
            const auto between = [&](float a, float b) { return a + (b - a) * rng.next_float(); };
            const Vec3 away = normalize(Vec3{between(-1, 1), between(-1, 1), between(-1, 1)});
            const Vec3 p = center + away * between(1.2f, 4);
            Ray ray;
            ray.origin = p;
            ray.time = rng.next_float();
            const float u = rng.next_float();
            const auto light = scene.lights->sample(p, {}, ray.time, u, rng.next_2d());
            if (!light || !(light->pdf > 0) || !(aim(ray, *light) > 0)) continue;
            ++found;
            hidden += scene.geometry->occluded(ray);
        }
        EXPECT_GT(found, 3000) << lamp.name;
        // A ray that starts anew thirty times goes a little beside its way: it may graze a tube's
        // other sides.
        EXPECT_LE(hidden, GetParam().has_windows ? found / 2000 : 0)
            << lamp.name << " of " << found;
    }
}

INSTANTIATE_TEST_SUITE_P(Places, Aim,
                         testing::Values(Case{"near"}, Case{"at_1000", 1000},
                                         Case{"at_10000", 1e4f}, Case{"moving", 0, true},
                                         Case{"moving_at_3000", 3000, true},
                                         Case{"behind_windows", 3000, false, true}),
                         [](const auto& instance) { return instance.param.name; });

/// The spacing of floats as large as v.
float step_at(float v) {
    return std::nextafter(v, kInfinity) - v;
}

/// A shade around a lamp of about unit size, `gap` away from it on either side.
struct Shaded {
    std::string name;
    ShapeDescription lamp;
    std::vector<ShapeDescription> shades;
};

std::vector<Shaded> shaded_lamps(float gap) {
    const Transform turn = Transform::rotate(37, {1, 2, 3});
    const auto turned = [&](const Transform& t) { return AnimatedTransform(turn * t); };
    BilinearMesh flat, wide;
    flat.positions = {{-0.5f, -0.4f, 0}, {0.6f, -0.5f, 0}, {-0.5f, 0.5f, 0}, {0.6f, 0.4f, 0}};
    flat.patches = wide.patches = {{0, 1, 2, 3}};
    for (Vec3 corner : flat.positions) wide.positions.push_back(corner * 2);
    // Shades of what is flat: the same, twice as large, on both sides
    const auto on_both_sides = [&](const auto& shade) {
        std::vector<ShapeDescription> both;
        for (const float z : {gap, -gap})
            both.push_back(shape_of(shade, turned(Transform::translate({0, 0, z}))));
        return both;
    };
    const auto mesh = [](const TriangleMesh& m) { return std::make_shared<const TriangleMesh>(m); };
    const auto patches = [](const BilinearMesh& m) {
        return std::make_shared<const BilinearMesh>(m);
    };
    TriangleMesh around = tube(12);
    const float wider = 1 + gap / (0.5f * std::cos(kPi / 12));
    for (Vec3& p : around.positions) p = {p.x * wider, p.y * wider, 2 * p.z};
    return {
        {"sphere",
         shape_of(whole_sphere(0.5f), turned({})),
         {shape_of(whole_sphere(0.5f + gap), turned({}))}},
        {"disk", shape_of(Disk{0, 0.5f, 0.1f, 360}, turned({})), on_both_sides(Disk{0, 1, 0, 360})},
        {"triangles", mesh_of(rectangle(1, 0.7f), turned({})),
         on_both_sides(mesh(rectangle(2, 1.4f)))},
        {"patch", shape_of(patches(flat), turned({})), on_both_sides(patches(wide))},
        {"tube", mesh_of(tube(12), turned({})), {mesh_of(around, turned({}))}},
    };
}

struct ShadeCase {
    std::string name;
    float far = 0;  ///< about how far from the origin
    /// Gap between lamp and shade over the spacing of floats there, beside some millionths of the
    /// way.
    float steps = 0;
    bool moves = false;
};
void PrintTo(const ShadeCase& c, std::ostream* out) {
    *out << c.name;
}

class Shade : public testing::TestWithParam<ShadeCase> {};

/// A shade hides its lamp, although only a few steps of single precision lie between both.
TEST_P(Shade, LetsNoLightOut) {
    const ShadeCase& c = GetParam();
    const Vec3 center = Vec3{1, 0.7f, -0.9f} * c.far;
    for (Shaded& shaded : shaded_lamps(1e-5f + c.steps * step_at(c.far))) {
        const auto place = [&](ShapeDescription shape) {
            const Transform at = shape.object_to_world.start();
            const Transform start = Transform::translate(center) * at;
            shape.object_to_world = AnimatedTransform(start);
            if (c.moves)
                shape.object_to_world =
                    AnimatedTransform(start, 0,
                                      Transform::translate(center + Vec3{0.3f, 0, 0.1f}) *
                                          Transform::rotate(20, {1, 1, 0}) * at,
                                      1);
            return shape;
        };
        LightScene scene;
        scene.description.camera.shutter_open = 0;
        scene.description.camera.shutter_close = 1;
        scene.add(place(shaded.lamp), Rgb(1));
        for (const ShapeDescription& shade : shaded.shades)
            scene.description.shapes.push_back(place(shade));
        scene.build();
        Rng rng(8);
        int found = 0, hidden = 0;
        for (int i = 0; i < 20000; ++i) {
            const auto between = [&](float a, float b) { return a + (b - a) * rng.next_float(); };
            const Vec3 away = normalize(Vec3{between(-1, 1), between(-1, 1), between(-1, 1)});
            Ray ray;
            ray.origin = center + away * between(1.2f, 4);
            ray.time = rng.next_float();
            const float u = rng.next_float();
            const auto light = scene.lights->sample(ray.origin, {}, ray.time, u, rng.next_2d());
            // Flat shades let light at grazing angles pass their borders
            if (!light || !(std::abs(dot(light->normal, light->wi)) > 0.1f)) continue;
            if (!(aim(ray, *light) > 0)) continue;
            ++found;
            hidden += scene.geometry->occluded(ray);
        }
        EXPECT_GT(found, 3000) << shaded.name;
        EXPECT_EQ(hidden, found) << shaded.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Places, Shade,
                         testing::Values(ShadeCase{"near"}, ShadeCase{"at_10", 10, 4},
                                         ShadeCase{"at_100", 100, 4}, ShadeCase{"at_1000", 1000, 4},
                                         ShadeCase{"at_3000", 3000, 4},
                                         ShadeCase{"at_10000", 1e4f, 4},
                                         ShadeCase{"moving", 0, 0, true},
                                         ShadeCase{"moving_at_3000", 3000, 8, true},
                                         ShadeCase{"moving_at_10000", 1e4f, 8, true}),
                         [](const auto& instance) { return instance.param.name; });

/// A lamp's housing hides it from afar, too.
TEST(AimedRay, MeetsHousingsOfDistantLamps) {
    LightScene scene;
    scene.add(shape_of(whole_sphere(0.2f)), Rgb(1));
    scene.description.shapes.push_back(shape_of(whole_sphere(0.23f)));
    scene.build();
    Rng rng(9);
    for (int i = 0; i < 2000; ++i) {
        Ray ray;
        ray.origin = Vec3{400, 100 * rng.next_float(), 100 * rng.next_float()};
        const float u = rng.next_float();
        const auto light = scene.lights->sample(ray.origin, {}, 0, u, rng.next_2d());
        ASSERT_TRUE(light);
        ASSERT_GT(aim(ray, *light), 0);
        EXPECT_TRUE(scene.geometry->occluded(ray));
    }
}

}  // namespace
}  // namespace covtrace
