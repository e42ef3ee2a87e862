// Flat mirrors: which there are, how they are chosen, the densities of lights that they show, and
// the covariance of such light.
#include "integrator/flat_mirrors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/parallel.h"
#include "core/rng.h"
#include "integrator/mirrored_light.h"
#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;

LitScene scene_with(const std::string& world) {
    return LitScene(read_pbrt_string("WorldBegin\n" + world, "test", "."));
}

const char* const kMetal = R"(Material "conductor" "float roughness" 0
)";

TEST(FlatMirrors, PartsOfAPlaneAreOne) {
    const LitScene scene = scene_with(std::string(kMetal) + R"(
Shape "trianglemesh" "point3 P" [ 0 0 0  1 0 0  1 1 0  0 1 0 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "bilinearmesh" "point3 P" [ 2 0 0  3 0 0  2 1 0  3 1 0 ]
Shape "trianglemesh" "point3 P" [ 0 0 2  0 1 2  0 1 3 ] "normal N" [ 1 0 0  1 0 0  1 0 0 ]
)");
    ASSERT_EQ(scene.mirrors.size(), 2u);
    const FlatMirror& largest = scene.mirrors[0];
    EXPECT_NEAR(std::abs(largest.normal.z), 1, 1e-6);
    EXPECT_NEAR(largest.area(), 3, 1e-5);
    EXPECT_NEAR(largest.brightness, 2.0 / 3, 1e-5);
    EXPECT_TRUE(largest.crossing({0.5f, 0.3f, 1}, {0, 0, -1}));
    EXPECT_TRUE(largest.crossing({2.5f, 0.7f, -1}, {0, 0, 1}));
    EXPECT_FALSE(largest.crossing({1.5f, 0.5f, 1}, {0, 0, -1}));
    EXPECT_FALSE(largest.crossing({0.5f, 0.3f, 1}, {0, 0, 1}));
    SurfaceHit hit;
    ASSERT_TRUE(scene.geometry.intersect({{2.5f, 0.7f, 1}, {0, 0, -1}}, hit));
    EXPECT_EQ(scene.mirrors.at(hit), 0);
    ASSERT_TRUE(scene.geometry.intersect({{1, 0.8f, 2.5f}, {-1, 0, 0}}, hit));
    EXPECT_EQ(scene.mirrors.at(hit), 1);
}

/// However far away other bodies are: images would be off by twice the step between the planes.
TEST(FlatMirrors, PlanesBesideEachOtherAreTwo) {
    for (const char* far_away :
         {"", "Material \"diffuse\"\nTranslate 0 0 20000\nShape \"sphere\""}) {
        const LitScene scene = scene_with(std::string(kMetal) + R"(
Shape "trianglemesh" "point3 P" [ 0 0 0  1 0 0  1 1 0  0 1 0 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 1 0 0.05  2 0 0.05  2 1 0.05  1 1 0.05 ] "integer indices" [ 0 1 2 0 2 3 ]
)" + far_away);
        EXPECT_EQ(scene.mirrors.size(), 2u) << far_away;
    }
}

/// However far away other mirrors are, which the steps by which planes are sorted hang on: both
/// planes are in one step then.
TEST(FlatMirrors, ParallelPlanesInOneStepAreTwo) {
    const LitScene scene = scene_with(std::string(kMetal) + R"(
Shape "trianglemesh" "point3 P" [ 0 0 0  1 0 0  1 1 0  0 1 0 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 1 0 0.05  2 0 0.05  2 1 0.05  1 1 0.05 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 0 0 900  0.1 0 900  0 0.1 900 ]
)");
    ASSERT_EQ(scene.mirrors.size(), 2u);
    for (const float x : {0.3f, 1.3f}) {
        SurfaceHit hit;
        ASSERT_TRUE(scene.geometry.intersect({{x, 0.6f, 1}, {0, 0, -1}}, hit));
        const int mirror = scene.mirrors.at(hit);
        ASSERT_GE(mirror, 0) << x;
        EXPECT_EQ(scene.mirrors[mirror].center.z, hit.position.z);
    }
}

TEST(FlatMirrors, NoneIsBentRoughMovedOrShining) {
    const char* const kTriangle = R"(Shape "trianglemesh" "point3 P" [ 0 0 0  1 0 0  1 1 0 ]
)";
    EXPECT_FALSE(scene_with(std::string(kMetal) + kTriangle).mirrors.is_empty());
    for (const std::string& other : {
             std::string("Material \"conductor\" \"float roughness\" 0.1\n") + kTriangle,
             std::string("Material \"diffuse\"\n") + kTriangle,
             std::string(kMetal) + "AreaLightSource \"diffuse\"\n" + kTriangle,
             std::string(kMetal) +
                 "ActiveTransform EndTime\nTranslate 1 0 0\nActiveTransform All\n" + kTriangle,
             std::string(kMetal) + "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  1 1 0 ] "
                                   "\"normal N\" [ 0 0 1  0 0.1 1  0 0 1 ]\n",
             std::string(kMetal) +
                 "Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0  1 1 0.1 ]\n",
             std::string(kMetal) + "Shape \"sphere\"\n",
         })
        EXPECT_TRUE(scene_with(other).mirrors.is_empty()) << other;
}

const std::string kThree = std::string(kMetal) + R"(
Shape "trianglemesh" "point3 P" [ 0 0 0  2 0 0  2 2 0  0 2 0 ] "integer indices" [ 0 1 2 0 2 3 ]
Shape "trianglemesh" "point3 P" [ 0 0 0  0 2 0  0 2 2  0 0 2 ] "integer indices" [ 0 1 2 0 2 3 ]
Material "dielectric"
Shape "trianglemesh" "point3 P" [ 0 0 3  2 0 3  2 2 3  0 2 3 ] "integer indices" [ 0 1 2 0 2 3 ]
)";

/// Shares of 100000 choices lie within 4.5 standard errors of the probabilities: three places and
/// three mirrors give a false alarm with a probability of 6e-5.
TEST(FlatMirrors, AreChosenWithTheirProbabilities) {
    const LitScene scene = scene_with(kThree);
    ASSERT_EQ(scene.mirrors.size(), 3u);
    Rng rng(7);
    constexpr int kCount = 100000;
    for (const Vec3 normal : {Vec3{}, Vec3{0, 0, -1}, Vec3{0, 1, 0}}) {
        const Vec3 p{1.2f, 0.6f, 0.9f};
        int counts[3] = {};
        double numbers = 0;
        for (int i = 0; i < kCount; ++i) {
            float u = rng.next_float();
            const auto choice = scene.mirrors.choose(p, normal, u);
            ASSERT_TRUE(choice);
            EXPECT_FLOAT_EQ(choice->probability,
                            scene.mirrors.probability(choice->mirror, p, normal));
            ++counts[choice->mirror];
            numbers += double(u) / kCount;
        }
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
            const double expected = double(scene.mirrors.probability(k, p, normal));
            EXPECT_NEAR(counts[k] / double(kCount), expected,
                        4.5 * std::sqrt(expected * (1 - expected) / kCount) + 1e-6);
            sum += expected;
        }
        EXPECT_NEAR(sum, 1, 1e-5);
        EXPECT_NEAR(numbers, 0.5, 0.01);  // what is left of u is even, too
    }
}

/// A lamp's image is seen within its solid angle, which samples of it by a mirror tell without
/// error but for rounding; and the density that a path is told for the same place on the lamp is
/// that of the sample.
TEST(MirroredLight, HasTheDensityThatPathsAreTold) {
    const LitScene scene = scene_with(kThree + R"(
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 3 3 3 ]
Translate 1.4 1.2 1.7
Shape "sphere" "float radius" 0.3
AttributeEnd
LightSource "infinite" "rgb L" [ 1 1 1 ]
)");
    const LitPlace place{{0.3f, 0.7f, 0.5f}, {0, 0, -1}};
    Rng rng(3);
    int lamps = 0, skies = 0;
    double angle = 0;
    constexpr int kCount = 20000;
    for (int i = 0; i < kCount; ++i) {
        float u = rng.next_float();
        const auto choice = scene.mirrors.choose(place.position, place.normal, u);
        ASSERT_TRUE(choice);
        const FlatMirror& mirror = scene.mirrors[choice->mirror];
        const MirroredPlace image(mirror, place);
        const float u_light = rng.next_float();
        const auto light =
            scene.lights.sample(image.position, image.normal, 0, u_light, rng.next_2d());
        if (!light) continue;
        const Vec3 wi = mirror.reflect_direction(light->wi);
        const auto t = mirror.crossing(place.position, wi);
        if (!t || !(*t < light->distance)) continue;
        const float pdf = choice->probability * light->pdf;
        if (!std::isfinite(light->distance)) {
            EXPECT_NEAR(density_by_mirror(scene, choice->mirror, place, light->wi, nullptr) / pdf,
                        1, 1e-3);
            ++skies;
            continue;
        }
        const Vec3 from = place.position + wi * *t;
        SurfaceHit hit;
        ASSERT_TRUE(scene.geometry.intersect({from + light->wi * 1e-3f, light->wi}, hit));
        if (is_black(scene.lights.emitted(hit, -light->wi))) continue;
        EXPECT_NEAR(density_by_mirror(scene, choice->mirror, place, light->wi, &hit) / pdf, 1,
                    1e-3);
        ++lamps;
        if (choice->mirror == 0) angle += 1 / (double(pdf) * kCount);
    }
    EXPECT_GT(lamps, 1000);
    EXPECT_GT(skies, 1000);
    const MirroredPlace image(scene.mirrors[0], place);
    const double d = double(distance(image.position, {1.4f, 1.2f, 1.7f}));
    // 20000 samples, of which a part is of this lamp by this mirror: 3 % are 4.5 standard errors
    EXPECT_NEAR(angle / (2 * 3.14159265 * (1 - std::sqrt(1 - 0.09 / (d * d)))), 1, 0.06);
}

std::string lamp_over_floor(const std::string& world) {
    return R"(Integrator "path" "integer maxdepth" 2
Film "rgb" "integer xresolution" 24 "integer yresolution" 24
LookAt 0 2 -3  0 0 0  0 1 0
Camera "perspective" "float fov" 8
WorldBegin
)" + world +
           R"(
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "point3 P" [ -4 0 -4  4 0 -4  4 0 1  -4 0 1 ] "integer indices" [ 0 1 2 0 2 3 ]
)";
}

/// The walk over the record makes of light that is sampled by a mirror what it makes of a path that
/// comes by it: bandwidths agree but for the noise of the latter, a few per cent.
TEST(MirroredLight, HasTheCovarianceOfAPathByTheMirror) {
    // The lamp looks at the mirror in the plane z = 2, away from the floor
    RenderScene scene(read_pbrt_string(lamp_over_floor(std::string(R"(AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 9 9 9 ]
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Shape "trianglemesh" "point3 P" [ -1 1.5 1.2  1 1.5 1.2  1 3 1.2  -1 3 1.2 ] "integer indices" [ 0 1 2 0 2 3 ]
AttributeEnd
)") + kMetal + R"(
Shape "trianglemesh" "point3 P" [ -5 0.2 2  5 0.2 2  5 5 2  -5 5 2 ] "integer indices" [ 0 1 2 0 2 3 ]
)"),
                                       "test", "."),
                      {}, kNoTextureLimit, Guides::none);
    for (const Occlusion occlusion : {Occlusion::none, Occlusion::query}) {
        RenderOptions options = covariance_method(256, 2);
        options.cov_spp = 256;
        options.occlusion = occlusion;
        Monitor monitor;
        scene.samples_by_mirrors = true;
        const Image sampled = render(scene, options, monitor).image;
        scene.samples_by_mirrors = false;
        const Image by_paths = render(scene, options, monitor).image;
        for (const char* layer : {"spectrum.xx", "spectrum.yy"}) {
            const double expected = middle_mean(by_paths, layer);
            EXPECT_GT(expected, 0);
            EXPECT_NEAR(middle_mean(sampled, layer) / expected, 1, 0.1)
                << layer << ", occlusion " << name_of(occlusion);
        }
    }
}

TEST(MirroredLight, DoesNotDependOnThreads) {
    const std::string text = lamp_over_floor(
        std::string(kMetal) +
        R"(Shape "trianglemesh" "point3 P" [ -5 0.2 2  5 0.2 2  5 5 2  -5 5 2 ] "integer indices" [ 0 1 2 0 2 3 ]
LightSource "distant" "point3 from" [ 0 3 -4 ] "point3 to" [ 0 0 0 ] "rgb L" [ 4 4 3 ] "float angle" 3
)");
    const auto with_threads = [&](int n) {
        const ThreadLimit limit(n);
        RenderScene scene(read_pbrt_string(text, "test", "."));
        EXPECT_TRUE(scene.samples_by_mirrors);
        Monitor monitor;
        return render(scene, uniform(4, 3), monitor).image;
    };
    const Image one = with_threads(1), three = with_threads(3);
    ASSERT_EQ(one.channels.size(), three.channels.size());
    for (size_t c = 0; c < one.channels.size(); ++c)
        EXPECT_EQ(std::memcmp(one.channels[c].values.data(), three.channels[c].values.data(),
                              one.channels[c].values.size() * sizeof(float)),
                  0);
}

}  // namespace
}  // namespace covtrace
