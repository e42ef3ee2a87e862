// Textures by the angle of sight.
#include <gtest/gtest.h>

#include <cmath>

#include "geometry_fixtures.h"
#include "light/lights.h"
#include "texture/graph.h"
#include "texture/spectra.h"
#include "texture_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

TexturePoint seen_at(float cosine) {
    TexturePoint at{{0.5f, 0.5f}, {}};
    at.facing = cosine;
    return at;
}

/// 1 at the rim, 0.2 in the middle, and something between; more behind.
TextureId rim(TextureScene& scene) {
    return scene.add(FacingTexture{{scene.add_float(2), scene.add_float(1), scene.add_float(0.7f),
                                    scene.add_float(0.2f)},
                                   {-1, 0, 0.3f, 1}},
                     false);
}

TEST(FacingTexture, IsLinearOverTheCosine) {
    TextureScene scene;
    const TextureId red = scene.add_constant({1, 0, 0}), blue = scene.add_constant({0, 0, 1});
    const TextureId checks = scene.add(CheckerboardTexture{2, {}, {}, red, blue});
    const TextureId id = scene.add(FacingTexture{{red, blue, checks}, {0.2f, 0.6f, 0.8f}});
    const TextureStore store(scene.description);
    EXPECT_EQ(store.eval(id, seen_at(0)), Rgb(1, 0, 0));
    EXPECT_EQ(store.eval(id, seen_at(0.2f)), Rgb(1, 0, 0));
    EXPECT_NEAR(store.eval(id, seen_at(0.3f)).b, 0.25f, 1e-6f);
    EXPECT_NEAR(store.eval(id, seen_at(0.3f)).r, 0.75f, 1e-6f);
    EXPECT_EQ(store.eval(id, seen_at(1)), Rgb(1, 0, 0)) << "the first square";
    EXPECT_TRUE(store.has_facing());
    EXPECT_FALSE(store.is_constant(id));
}

TEST(FacingTexture, HasTheSameValueBehindUnlessACosineIsNegative) {
    TextureScene scene;
    const TextureId front = scene.add_float(0.25f), behind = scene.add_float(1);
    const TextureId alike = scene.add(FacingTexture{{front, behind}, {0, 1}}, false);
    const TextureId step = scene.add(FacingTexture{{behind, front}, {-1e-6f, 0}}, false);
    const TextureStore store(scene.description);
    for (float cosine : {0.1f, 0.6f, 1.0f}) {
        EXPECT_EQ(store.eval_float(alike, seen_at(-cosine)),
                  store.eval_float(alike, seen_at(cosine)));
        EXPECT_EQ(store.eval_float(step, seen_at(-cosine)), 1);
        EXPECT_EQ(store.eval_float(step, seen_at(cosine)), 0.25f);
    }
}

TEST(FacingTexture, OfOneValueIsConstant) {
    TextureScene scene;
    const TextureId half = scene.add_float(0.5f);
    const TextureId id = scene.add(FacingTexture{{half, scene.add_float(0.5f)}, {0, 1}}, false);
    const TextureStore store(scene.description);
    EXPECT_TRUE(store.is_constant(id));
    EXPECT_FALSE(store.has_facing());
    EXPECT_EQ(store.eval_float(id, seen_at(0.4f)), 0.5f);
}

TEST(FacingTexture, FromNowhereIsTheMeanOverAllDirections) {
    for (const std::vector<float>& cosines : {std::vector<float>{0, 0.3f, 1},
                                              {0.1f, 0.2f, 0.7f},
                                              {0.9f, 0.95f, 0.96f},
                                              {-1, 0.3f, 1},
                                              {-0.8f, -0.3f, -0.1f},
                                              {-0.5f, 0, 0.7f}}) {
        TextureScene scene;
        const TextureId id = scene.add(
            FacingTexture{{scene.add_float(1), scene.add_float(0.1f), scene.add_float(0.6f)},
                          cosines},
            false);
        const TextureStore store(scene.description);
        // Equal steps of the squared cosine are equal shares of the directions.
        constexpr int kSteps = 20000;
        double sum = 0;
        for (int i = 0; i < kSteps; ++i) {
            const float cosine = std::sqrt((float(i) + 0.5f) / kSteps);
            sum += 0.5f *
                   (store.eval_float(id, seen_at(cosine)) + store.eval_float(id, seen_at(-cosine)));
        }
        EXPECT_NEAR(store.eval_float(id, {{0.5f, 0.5f}, {}}), sum / kSteps, 1e-4);
        EXPECT_NEAR(store.mean(id).r, sum / kSteps, 1e-4);
    }
}

TEST(FacingTexture, HasTheCovarianceOfItsNeighbours) {
    TextureScene scene;
    const TextureId grey = scene.add_float(0.5f);
    const TextureId noise = scene.add(NoiseTexture{}, false);
    const TextureId id = scene.add(FacingTexture{{grey, noise}, {0, 1}}, false);
    const TextureStore store(scene.description);
    const TextureSpectra spectra(store);
    const auto covariance = [&](TextureId texture, float cosine) {
        TexturePoint at = seen_at(cosine);
        at.position = {0.3f, 0.4f, 0.2f};
        return spectra.uv_covariance(texture, at, {1, 0, 0}, {0, 1, 0}, 1e-3f);
    };
    EXPECT_EQ(covariance(id, 0).ss, 0);
    EXPECT_EQ(covariance(id, 1).ss, covariance(noise, 1).ss);
    EXPECT_GT(covariance(id, 0.5f).ss, 0);
    EXPECT_LT(covariance(id, 0.5f).ss, covariance(noise, 1).ss);
}

TEST(FacingTexture, HitsTellTheCosineToTheInterpolatedNormal) {
    const Geometry moved(
        scene_of({mesh(sphere_mesh(1, 8, 12), AnimatedTransform(Transform::scale(1, 2, 1)))}));
    Random random(3);
    float most = 0;
    for (int i = 0; i < 200; ++i) {
        const Vec3 from = random.direction() * 5.0f, to = random.in_box(0.4f);
        const Ray ray{from, normalize(to - from)};
        SurfaceHit hit;
        ASSERT_TRUE(moved.intersect(ray, hit));
        EXPECT_NEAR(hit.facing, std::abs(dot(hit.ns, ray.direction)), 1e-6f);
        const Ray from_within{to, ray.direction};
        ASSERT_TRUE(moved.intersect(from_within, hit));
        EXPECT_NEAR(hit.facing, -std::abs(dot(hit.ns, ray.direction)), 1e-6f);
        ASSERT_TRUE(moved.intersect(ray, hit));
        most = std::max(most, std::abs(hit.facing - std::abs(dot(hit.ng, ray.direction))));
    }
    EXPECT_GT(most, 0.05f);
}

/// Sampled light and light that is met agree, on meshes whose normals are others than those of
/// their triangles, on patches and on spheres, and where these move.
TEST(FacingTexture, LightsShineByIt) {
    BilinearMesh patch_mesh = patch({-1, -1, 0}, {1, -1, 0.3f}, {-1, 1, 0.2f}, {1, 1, 0});
    patch_mesh.normals = {normalize(Vec3{-1, -1, 2}), normalize(Vec3{1, -1, 2}),
                          normalize(Vec3{-1, 1, 2}), normalize(Vec3{1, 1, 2})};
    const AnimatedTransform turned(
        chain({Transform::translate({0.2f, 0, 0}), Transform::rotate(40, {1, 2, 0}),
               Transform::scale(1, 1.5f, 0.7f)}),
        0, Transform::translate({0.5f, 0, 0}), 1);
    for (ShapeDescription emitter :
         {mesh(sphere_mesh(1, 6, 8), turned), patches(patch_mesh, turned),
          shape(sphere(1), AnimatedTransform(Transform::translate({0.2f, 0, 0})))}) {
        TextureScene scene;
        AreaLightDescription light;
        light.image = rim(scene);
        light.two_sided = true;
        scene.description.area_lights.push_back(light);
        emitter.area_light = 0;
        scene.description.shapes.push_back(emitter);
        const TextureStore store(scene.description);
        const Geometry geometry(scene.description);
        const Lights lights(scene.description, geometry, &store);
        Random random(5);
        int met = 0;
        float least = 1, most = 0;
        for (int i = 0; i < 400; ++i) {
            const Vec3 p = random.direction() * 4.0f;
            const float time = random.next();
            const auto sample = lights.finish_draw(
                p, {}, time, random.next(), lights.begin_draw({random.next(), random.next()}));
            if (!sample) continue;
            SurfaceHit hit;
            const Ray ray{p, sample->wi, time};
            // Samples behind the emitter's own front are met nowhere
            if (!geometry.intersect(ray, hit) || std::abs(hit.t - sample->distance) > 1e-3f)
                continue;
            ++met;
            const float seen = lights.emitted(hit, -sample->wi).r;
            EXPECT_NEAR(sample->radiance.r, seen, 2e-3f);
            least = std::min(least, seen);
            most = std::max(most, seen);
        }
        EXPECT_GT(met, 100);
        EXPECT_GT(most - least, 0.3f);
    }
}

}  // namespace
}  // namespace covtrace
