/// Emission of lights, and its side; the spread of power; the shapes that emit at all.
#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/warp.h"
#include "light_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

SurfaceHit hit_of(const LightScene& s, Vec3 from, Vec3 towards) {
    SurfaceHit hit;
    EXPECT_TRUE(s.geometry->intersect({from, normalize(towards - from)}, hit));
    return hit;
}

Rgb seen(const LightScene& s, Vec3 from, Vec3 towards) {
    return s.lights->emitted(hit_of(s, from, towards), normalize(from - towards));
}

/// Whether light sampling finds anything at p.
bool lit(const LightScene& s, Vec3 p) {
    Rng rng(1);
    for (int i = 0; i < 100; ++i) {
        const float u = rng.next_float();
        if (s.lights->sample(p, {}, 0, u, rng.next_2d())) return true;
    }
    return false;
}

TEST(Emission, OneSidedShapesShineOutwardsOnly) {
    LightScene s;
    s.add(mesh_of(rectangle(2, 2)), Rgb(3));
    s.build();
    EXPECT_EQ(seen(s, {0.1f, 0.2f, 1}, {0.1f, 0.2f, 0}), Rgb(3));
    EXPECT_EQ(seen(s, {0.1f, 0.2f, -1}, {0.1f, 0.2f, 0}), Rgb(0));
    EXPECT_TRUE(lit(s, {0, 0, 1}));
    EXPECT_FALSE(lit(s, {0, 0, -1}));
}

TEST(Emission, TwoSidedShapesShineBothWays) {
    LightScene s;
    s.add(mesh_of(rectangle(2, 2)), Rgb(3), true);
    s.build();
    EXPECT_EQ(seen(s, {0.1f, 0.2f, -1}, {0.1f, 0.2f, 0}), Rgb(3));
    EXPECT_TRUE(lit(s, {0, 0, 1}) && lit(s, {0, 0, -1}));
}

/// Samples for places outside of a sphere lie on its nearer side: paths that come to the inner face
/// of the other one, as the sphere lets them pass, must count in full.
TEST(Emission, TheFarSideOfASphereIsNotSampledFromOutside) {
    LightScene s;
    s.add(shape_of(whole_sphere(1)), Rgb(3), true);
    s.build();
    const Vec3 inside{0.1f, 0.2f, 0}, towards{0, 0.3f, 4}, outside{0, 0.3f, -4};
    const SurfaceHit far_side = hit_of(s, inside, towards), near_side = hit_of(s, outside, inside);
    EXPECT_EQ(s.lights->pdf(outside, {}, normalize(far_side.position - outside), far_side), 0);
    EXPECT_GT(s.lights->pdf(outside, {}, normalize(near_side.position - outside), near_side), 0);
    EXPECT_GT(s.lights->pdf(inside, {}, normalize(far_side.position - inside), far_side), 0);
}

TEST(Emission, OrientationMirroringAndVertexNormalsAgreeWithHits) {
    const auto reversed = [](ShapeDescription d) {
        d.reverse_orientation = true;
        return d;
    };
    TriangleMesh with_normals = rectangle(2, 2);
    with_normals.normals.assign(4, {0, 0, -1});
    const AnimatedTransform mirror(Transform::scale(1, 1, -1)),
        mirror_x(Transform::scale(-1, 1, 1));
    const AnimatedTransform moving(Transform::scale(-1, 1, 1), 0,
                                   Transform::translate({0.1f, 0, 0}) * Transform::scale(-1, 1, 1),
                                   1);
    const std::vector<ShapeDescription> shapes = {
        mesh_of(rectangle(2, 2)),
        reversed(mesh_of(rectangle(2, 2))),
        mesh_of(rectangle(2, 2), mirror),
        mesh_of(rectangle(2, 2), mirror_x),
        reversed(mesh_of(rectangle(2, 2), mirror_x)),
        mesh_of(with_normals),
        reversed(mesh_of(with_normals)),
        mesh_of(with_normals, mirror),
        mesh_of(with_normals, mirror_x),
        mesh_of(rectangle(2, 2), moving),
        mesh_of(with_normals, moving),
        patch_of({-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}),
        patch_of({-1, -1, 0}, {-1, 1, 0}, {1, -1, 0}, {1, 1, 0}),
        shape_of(Disk{}),
        reversed(shape_of(Disk{})),
        shape_of(Disk{}, mirror),
        shape_of(Disk{}, mirror_x)};
    for (size_t i = 0; i < shapes.size(); ++i) {
        LightScene s;
        s.add(shapes[i], Rgb(3));
        s.build();
        for (const float z : {1.0f, -1.0f})
            EXPECT_EQ(lit(s, {0.1f, 0.2f, z}), !is_black(seen(s, {0.1f, 0.2f, z}, {0.1f, 0.2f, 0})))
                << i << " " << z;
        EXPECT_NE(lit(s, {0.1f, 0.2f, 1}), lit(s, {0.1f, 0.2f, -1})) << i;
    }
    for (const bool reverse : {false, true})
        for (const auto& t : {AnimatedTransform(), mirror}) {
            LightScene s;
            ShapeDescription d = shape_of(whole_sphere(1), t);
            d.reverse_orientation = reverse;
            s.add(d, Rgb(3));
            s.build();
            EXPECT_EQ(lit(s, {2, 0, 0}), !reverse);
            EXPECT_EQ(lit(s, {0.2f, 0, 0}), reverse);
            EXPECT_EQ(is_black(seen(s, {2, 0, 0}, {0, 0, 0})), reverse);
        }
}

TEST(Emission, PowerIsWhatTheWholeShapeEmits) {
    const AnimatedTransform stretched(Transform::rotate(30, {1, 2, 3}) *
                                      Transform::scale(2, 0.5, 1));
    const std::vector<std::pair<ShapeDescription, double>> shapes_and_areas = {
        {mesh_of(rectangle(2, 3)), 6},
        {mesh_of(cube()), 24},
        {shape_of(whole_sphere(0.5f), AnimatedTransform(Transform::scale(2, 2, 2))), 4 * M_PI},
        // Knud Thomsen's formula for ellipsoids is good to about one percent.
        {shape_of(whole_sphere(1), stretched),
         4 * M_PI *
             std::pow((std::pow(1, 1.6075) + std::pow(2, 1.6075) + std::pow(0.5, 1.6075)) / 3,
                      1 / 1.6075)},
        {shape_of(Disk{0, 2, 1, 180}), 1.5 * M_PI},
        {shape_of(Disk{0, 1, 0, 360}, AnimatedTransform(Transform::scale(2, 3, 1))), 6 * M_PI},
        {patch_of({-1, -1, 0}, {1, -1, 0}, {-0.5f, 1, 0}, {0.5f, 1, 0}), 3}};
    for (const bool two_sided : {false, true})
        for (const auto& [shape, area] : shapes_and_areas) {
            LightScene s;
            s.add(shape, Rgb(5, 2, 1), two_sided);
            s.description.area_lights[0].power = 100.0f;
            s.build();
            SurfaceHit hit;
            hit.ng = {0, 0, 1};
            const Rgb l = s.lights->emitted(hit, {0, 0, 1});
            EXPECT_NEAR(luminance(l) * M_PI * area * (two_sided ? 2 : 1), 100, 1.2);
            EXPECT_NEAR(l.r / l.b, 5, 1e-4);
        }
}

TEST(Emission, PowerOfASpotIsItsIntensityOverAllDirections) {
    LightScene s;
    s.add_light(SpotLight{.intensity = Rgb(1, 2, 3),
                          .power = 50.0f,
                          .from = {1, 1, 1},
                          .to = {1, 5, 2},
                          .cone_angle = 40,
                          .cone_delta_angle = 15},
                Transform::rotate(20, {0, 1, 0}));
    s.build();
    const Vec3 at = Transform::rotate(20, {0, 1, 0}).point({1, 1, 1});
    double sum = 0;
    Rng rng(2);
    constexpr int kSamples = 200000;
    for (int i = 0; i < kSamples; ++i)
        if (const auto l =
                s.lights->sample(at + square_to_sphere(rng.next_2d()) * 2, {}, 0, 0.5f, {}))
            sum += double(luminance(l->radiance)) * 4 / double(l->pdf);
    EXPECT_NEAR(sum / kSamples * 4 * M_PI, 50, 0.8);
}

TEST(Emission, SpotsWithMoreFalloffThanConeShineWithinTheDifference) {
    LightScene s;
    s.add_light(SpotLight{.intensity = Rgb(1),
                          .power = {},
                          .from = {},
                          .to = {0, 0, 1},
                          .cone_angle = 20,
                          .cone_delta_angle = 30});
    s.build();
    const auto at = [&s](float degrees) {
        const float a = degrees * kPi / 180;
        const auto l = s.lights->sample({std::sin(a), 0, std::cos(a)}, {}, 0, 0.5f, {});
        return l ? l->radiance.r / l->pdf : 0.0f;
    };
    EXPECT_NEAR(at(9), 1, 1e-5f);  // pbrt takes the cosine of 20 - 30 degrees
    EXPECT_LT(at(15), 0.9f);
    EXPECT_GT(at(15), 0.1f);
    EXPECT_EQ(at(21), 0);
}

TEST(Emission, SoftFalloffOfWhatIsNoBallIsTold) {
    for (const bool is_ball : {true, false}) {
        LightScene s;
        s.add(is_ball ? shape_of(whole_sphere(1)) : shape_of(Disk{}), Rgb(2));
        s.description.area_lights[0].soft_falloff = true;
        s.build();
        EXPECT_EQ(s.lights->warnings().size(), is_ball ? 0u : 1u);
    }
    LightScene part;
    part.add(shape_of(Sphere{.radius = 1, .z_min = 0, .z_max = 1}), Rgb(2));
    part.description.area_lights[0].soft_falloff = true;
    part.build();
    EXPECT_EQ(part.lights->warnings().size(), 1u);
    EXPECT_EQ(seen(part, {0, 0, 1.5f}, {0, 0, 0}), Rgb(2));
}

TEST(Emission, SoftFalloffIsThatOfADiscThatFacesThePlace) {
    // A sphere's irradiance at a surface that faces its centre is pi L r^2 / d^2, a disc's pi L r^2
    // / (d^2 + r^2).
    LightScene s;
    const size_t shape =
        s.add(shape_of(Sphere{.radius = 0.5f}, AnimatedTransform(Transform::translate({1, 2, 3}))),
              Rgb(2));
    s.description.area_lights[0].soft_falloff = true;
    s.build();
    for (const float d : {0.6f, 1.0f, 5.0f}) {
        const Vec3 p{1, 2, 3 - d};
        double sum = 0;
        Rng rng(1);
        constexpr int kSamples = 20000;
        for (int i = 0; i < kSamples; ++i)
            if (const auto l = s.lights->sample(p, {}, 0, 0.5f, rng.next_2d()))
                sum += double(l->radiance.r * l->wi.z / l->pdf);
        EXPECT_NEAR(sum / kSamples, M_PI * 2 * 0.25 / (d * d + 0.25), 0.01) << d;
        SurfaceHit hit;
        hit.shape = static_cast<uint32_t>(shape);
        hit.ng = {0, 0, -1};
        hit.position = {1, 2, 2.5f};
        EXPECT_NEAR(s.lights->emitted(hit, {0, 0, -1}, d - 0.5f).r, 2 * d * d / (d * d + 0.25f),
                    1e-4f);
        EXPECT_EQ(s.lights->emitted(hit, {0, 0, -1}).r, 2);
    }
}

TEST(Emission, SpotsFallOffSmoothlyBetweenTheirCones) {
    LightScene s;
    s.add_light(SpotLight{.intensity = Rgb(1),
                          .power = {},
                          .from = {},
                          .to = {0, 0, 1},
                          .cone_angle = 30,
                          .cone_delta_angle = 10});
    s.build();
    const auto at = [&s](float degrees) {
        const float a = degrees * kPi / 180;
        const auto l = s.lights->sample({std::sin(a), 0, std::cos(a)}, {}, 0, 0.5f, {});
        return l ? l->radiance.r / l->pdf : 0.0f;
    };
    EXPECT_NEAR(at(0), 1, 1e-5);
    EXPECT_NEAR(at(19.9f), 1, 1e-5);
    EXPECT_EQ(at(30.1f), 0);
    // The middle is half way in the cosine, not in the angle.
    const float middle =
        std::acos((std::cos(20 * kPi / 180) + std::cos(30 * kPi / 180)) / 2) * 180 / kPi;
    EXPECT_NEAR(at(middle), 0.5, 1e-3);
}

TEST(Emission, HiddenShapesLightTheSceneButAreNotSeen) {
    LightScene visible, hidden;
    for (LightScene* s : {&visible, &hidden}) s->add(mesh_of(rectangle(1, 1)), Rgb(3));
    TextureDescription zero;
    zero.value = ConstantTexture{Rgb(0)};
    hidden.description.textures.push_back(zero);
    hidden.description.shapes[0].alpha = 0;
    double sums[2] = {};
    for (LightScene* s : {&visible, &hidden}) {
        s->build();
        Rng rng(3);
        for (int i = 0; i < 2000; ++i) {
            const auto l = s->lights->sample({0, 0, 1}, {0, 0, -1}, 0, 0.5f, rng.next_2d());
            ASSERT_TRUE(l);
            EXPECT_EQ(l->is_delta, s == &hidden);
            sums[s == &hidden] += double(l->radiance.r / l->pdf);
        }
    }
    EXPECT_NEAR(sums[1] / sums[0], 1, 1e-5);
    SurfaceHit hit;
    EXPECT_FALSE(hidden.geometry->intersect({{0.1f, 0.2f, 1}, {0, 0, -1}}, hit));
    EXPECT_FALSE(hidden.geometry->occluded({{0.1f, 0.2f, 1}, {0, 0, -1}}));
}

TEST(Emission, LightsWhoseAlphaHangsOnPositionAreChosen) {
    // The texture is transparent as far around the origin as textures are asked for their mean, and
    // opaque in the cell beyond, which the light is in.
    LightScene s;
    const auto add_texture = [&s](auto value) {
        TextureDescription texture;
        texture.is_spectrum = false;
        texture.value = std::move(value);
        s.description.textures.push_back(texture);
        return TextureId(s.description.textures.size() - 1);
    };
    CheckerboardTexture cells;
    cells.dimension = 3;
    cells.texture_from_world =
        Transform::scale(1e-3, 1e-3, 1e-3) * Transform::translate({500, 500, 500});
    cells.tex1 = add_texture(ConstantTexture{Rgb(0)});
    cells.tex2 = add_texture(ConstantTexture{Rgb(1)});
    ShapeDescription light =
        mesh_of(rectangle(0.5f, 0.5f), placed({Transform::translate({601, 0.5f, 0.5f})}));
    light.alpha = add_texture(cells);
    s.add(light, Rgb(3));
    s.add(mesh_of(rectangle(0.5f, 0.5f), placed({Transform::translate({600, 0.5f, 0.5f})})),
          Rgb(3));
    const TextureStore textures(s.description);
    s.geometry = std::make_unique<Geometry>(s.description);
    s.lights = std::make_unique<Lights>(s.description, *s.geometry, &textures);
    const Vec3 p{600.5f, 0.5f, 2}, n{0, 0, -1};
    // The light is chosen a twentieth as often as the same light without alpha.
    const float with = s.lights->selection_probability(p, n, 0),
                without = s.lights->selection_probability(p, n, 2);
    EXPECT_NEAR(with / without, 0.05, 0.01);
}

TEST(Emission, OtherShapesAreDark) {
    LightScene s;
    s.description.shapes.push_back(shape_of(whole_sphere(1)));
    s.add(shape_of(whole_sphere(1), AnimatedTransform(Transform::translate({5, 0, 0}))), Rgb(2));
    s.build();
    const SurfaceHit dark = hit_of(s, {0, 0, 3}, {0, 0, 0});
    EXPECT_EQ(s.lights->emitted(dark, {0, 0, 1}), Rgb(0));
    EXPECT_EQ(s.lights->pdf({0, 0, 3}, {}, {0, 0, -1}, dark), 0);
    EXPECT_EQ(seen(s, {5, 0, 3}, {5, 0, 0}), Rgb(2));
    EXPECT_EQ(s.lights->count(), 1);
}

TEST(Emission, ShapesOfInstancedObjectsAreDark) {
    LightScene s;
    AreaLightDescription light;
    light.radiance = Rgb(2);
    s.description.area_lights.push_back(light);
    ShapeDescription sphere = shape_of(whole_sphere(1));
    sphere.area_light = 0;
    s.description.objects.push_back({"lamp", {sphere}});
    s.description.instances.push_back({0, AnimatedTransform(), {}});
    s.build();
    EXPECT_EQ(s.lights->count(), 0);
    EXPECT_EQ(seen(s, {0, 0, 3}, {0, 0, 0}), Rgb(0));
}

TEST(Emission, ASceneWithoutLightsHasNoSamples) {
    LightScene s;
    s.build();
    EXPECT_EQ(s.lights->count(), 0);
    EXPECT_FALSE(s.lights->has_environment());
    EXPECT_FALSE(s.lights->sample({}, {0, 0, 1}, 0, 0.5f, {0.5f, 0.5f}));
    EXPECT_EQ(s.lights->environment({}, {0, 0, 1}), Rgb(0));
    EXPECT_EQ(s.lights->environment_pdf({}, {0, 0, 1}, {0, 0, 1}), 0);
}

TEST(Emission, DegenerateLightsAreHarmless) {
    LightScene s;
    TriangleMesh flat;
    flat.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    flat.triangles = {{0, 1, 2}, {0, 0, 0}};
    s.add(mesh_of(flat), Rgb(3));
    s.add(mesh_of(TriangleMesh{}), Rgb(3));
    s.add(mesh_of(rectangle(1, 1)), Rgb(0));
    s.add_light(PointLight{.intensity = Rgb(1), .power = {}, .from = {0, 0, 1}});
    s.description.area_lights[0].power = 10.0f;
    s.build_with_spectra();
    Rng rng(5);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 p = i == 0 ? Vec3{0, 0, 1} : square_to_sphere(rng.next_2d());
        const float u = rng.next_float();
        if (const auto l = s.lights->sample(p, {}, 0, u, rng.next_2d())) {
            ASSERT_TRUE(is_finite(l->radiance) && is_finite(l->wi) && std::isfinite(l->pdf));
            ASSERT_EQ(l->light, 4) << "only the point light shines";
        }
    }
}

TEST(Emission, DamagedTexelsOfLightImagesDoNotOverflow) {
    // Sums and means of such texels would be infinite, and the choice among lights not a number.
    const TemporaryImage image({Rgb(3e38f), Rgb(1), Rgb(1), Rgb(3e38f)}, 2, 2);
    for (const bool is_slide : {false, true}) {
        LightScene s;
        if (is_slide)
            s.add_light(ProjectionLight{.scale = 1, .fov = 90, .image = image.path()});
        else
            s.add_light(GoniometricLight{.intensity = Rgb(1), .image = image.path()});
        s.add_light(PointLight{.intensity = Rgb(1), .from = {1, 0, 0}});
        s.build();
        const Vec3 p{0.1f, 0.1f, 1};
        EXPECT_TRUE(std::isfinite(s.lights->total_power().g));
        EXPECT_NEAR(
            s.lights->selection_probability(p, {}, 0) + s.lights->selection_probability(p, {}, 1),
            1, 1e-5f);
        EXPECT_TRUE(s.lights->sample(p, {}, 0, 0.5f, {0.5f, 0.5f}));
    }
}

}  // namespace
}  // namespace covtrace
