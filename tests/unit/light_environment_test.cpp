#include "light/environment.h"

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/warp.h"
#include "light/equal_area.h"
#include "light_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

Vec3 from_angles(float theta, float phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// The texels of a map that is f(direction) at their centres.
template <class F>
std::vector<Rgb> texels_of(int width, int height, F f) {
    std::vector<Rgb> texels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Vec2 uv{(float(x) + 0.5f) / float(width), (float(y) + 0.5f) / float(height)};
            texels.push_back(f(width == height ? equal_area_square_to_sphere(uv)
                                               : from_angles(kPi * uv.y, 2 * kPi * uv.x)));
        }
    return texels;
}

InfiniteLight image_light(const TemporaryImage& image) {
    InfiniteLight light;
    light.image = image.path();
    return light;
}

Environment environment(const InfiniteLight& light, const Transform& light_to_world = {}) {
    Warnings warnings;
    return Environment(light, light_to_world, {}, warnings);
}

TEST(EqualArea, RoundTrips) {
    Rng rng(1);
    for (int i = 0; i < 100000; ++i) {
        const Vec2 uv = rng.next_2d();
        const Vec3 w = equal_area_square_to_sphere(uv);
        ASSERT_NEAR(length(w), 1, 1e-6);
        const Vec2 back = equal_area_sphere_to_square(w);
        ASSERT_NEAR(back.x, uv.x, 2e-6);
        ASSERT_NEAR(back.y, uv.y, 2e-6);
    }
    for (int i = 0; i < 100000; ++i) {
        const Vec3 w = square_to_sphere(rng.next_2d());
        ASSERT_LT(distance(equal_area_square_to_sphere(equal_area_sphere_to_square(w)), w), 3e-6f);
    }
}

TEST(EqualArea, PlacesThePolesAndAxesAsPbrtDoes) {
    const auto expect = [](Vec2 uv, Vec3 w) {
        EXPECT_LT(distance(equal_area_square_to_sphere(uv), w), 1e-6f) << uv.x << " " << uv.y;
    };
    expect({0.5f, 0.5f}, {0, 0, 1});
    for (float u : {0.0f, 1.0f})
        for (float v : {0.0f, 1.0f}) expect({u, v}, {0, 0, -1});
    expect({1, 0.5f}, {1, 0, 0});
    expect({0, 0.5f}, {-1, 0, 0});
    expect({0.5f, 1}, {0, 1, 0});
    expect({0.5f, 0}, {0, -1, 0});
    for (const Vec3 w : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{0, -1, 0}}) {
        const Vec2 uv = equal_area_sphere_to_square(w);
        EXPECT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
        expect(uv, w);
    }
}

TEST(EqualArea, KeepsAreas) {
    constexpr int kCells = 16;
    for (int i = 0; i < kCells; ++i)
        for (int j = 0; j < kCells; ++j) {
            // The Jacobian by differences, away from the creases of the map.
            constexpr float kStep = 1e-3f;
            const Vec2 uv{(float(i) + 0.37f) / kCells, (float(j) + 0.41f) / kCells};
            const Vec3 du = equal_area_square_to_sphere({uv.x + kStep, uv.y}) -
                            equal_area_square_to_sphere({uv.x - kStep, uv.y});
            const Vec3 dv = equal_area_square_to_sphere({uv.x, uv.y + kStep}) -
                            equal_area_square_to_sphere({uv.x, uv.y - kStep});
            EXPECT_NEAR(length(cross(du, dv)) / (4 * kStep * kStep), 4 * kPi, 0.01 * 4 * kPi)
                << i << " " << j;
        }
}

TEST(EnvironmentMap, LatLongAndEqualAreaShowTheSamePicture) {
    const auto sky = [](Vec3 w) {
        return Rgb(1 + w.x, 1 + 0.5f * w.y * w.z, 2 + w.z) +
               Rgb(std::exp(-20 * (1 - dot(w, normalize(Vec3{1, 2, 1})))));
    };
    const EnvironmentMap square(texels_of(512, 512, sky), 512, 512);
    const EnvironmentMap lat_long(texels_of(1024, 512, sky), 1024, 512);
    EXPECT_NEAR(luminance(square.mean()) / luminance(lat_long.mean()), 1, 1e-4);
    EXPECT_NEAR(
        luminance(square.irradiance_from_above()) / luminance(lat_long.irradiance_from_above()), 1,
        1e-3);
    Rng rng(2);
    for (int i = 0; i < 20000; ++i) {
        // Directions are compared at the centres of the square map's texels, within which it does
        // not change.
        const Vec2 uv = rng.next_2d();
        const Vec3 w = equal_area_square_to_sphere(
            {(std::floor(512 * uv.x) + 0.5f) / 512, (std::floor(512 * uv.y) + 0.5f) / 512});
        for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(square.radiance(w)[c], sky(w)[c], 0.01);
            ASSERT_NEAR(lat_long.radiance(w)[c], sky(w)[c], 0.01);
        }
        ASSERT_NEAR(square.pdf(w) * 4 * kPi, lat_long.pdf(w) * 4 * kPi, 0.02);
    }
}

TEST(EnvironmentMap, EqualAreaTexelsAreConstantAsInPbrt) {
    // The map has one texel of 10 and is even else: pbrt-v4's ImageInfiniteLight looks up the
    // nearest texel.
    constexpr int kSide = 8;
    std::vector<Rgb> texels(kSide * kSide, Rgb(0.1f));
    texels[2 * kSide + 3] = Rgb(10);
    const EnvironmentMap map(texels, kSide, kSide);
    const auto at = [&](float x, float y) {
        return map.radiance(equal_area_square_to_sphere({x / kSide, y / kSide})).g;
    };
    for (const float inside : {3.02f, 3.5f, 3.98f}) EXPECT_EQ(at(inside, 2.5f), 10) << inside;
    for (const float outside : {2.98f, 4.02f}) EXPECT_EQ(at(outside, 2.5f), 0.1f) << outside;
}

TEST(EnvironmentMap, DirectionsAreDrawnForWhatStandsOut) {
    // Texels darker than most of the mean are left to BSDFs; even maps are drawn from evenly.
    for (const int width : {32, 64}) {
        const EnvironmentMap even(std::vector<Rgb>(size_t(width) * 32, Rgb(2)), width, 32);
        EXPECT_NEAR(even.drawn_share(), 1 - EnvironmentMap::kLeftOut, 1e-5);
        EXPECT_NEAR(even.pdf(from_angles(1.2f, 0.3f)) * 4 * kPi, 1, 0.02);
        const EnvironmentMap sunny(sky_with_sun(width, 32, 9, 10, 5000), width, 32);
        EXPECT_GT(sunny.drawn_share(), 0.5f);
        Rng rng(6);
        for (int i = 0; i < 1000; ++i)
            ASSERT_GT(luminance(sunny.radiance(sunny.sample(rng.next_2d()))),
                      EnvironmentMap::kLeftOut * luminance(sunny.mean()) * 0.99f);
    }
}

TEST(EnvironmentMap, IrradianceFromAboveIsThatOfTheUpperHalf) {
    const auto upper = [](Vec3 w) { return Rgb(w.z > 0 ? 2.0f : 100.0f); };
    EXPECT_NEAR(EnvironmentMap(texels_of(256, 256, upper), 256, 256).irradiance_from_above().g,
                2 * kPi, 0.02);
    EXPECT_NEAR(EnvironmentMap(texels_of(512, 256, upper), 512, 256).irradiance_from_above().g,
                2 * kPi, 0.02);
}

TEST(EnvironmentMap, TinyAndBlackImagesWork) {
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {2, 2}, {4, 2}}) {
        const EnvironmentMap map(std::vector<Rgb>(size_t(width * height), Rgb(3)), width, height);
        EXPECT_NEAR(luminance(map.mean()), 3, 1e-5);
        Rng rng(3);
        for (int i = 0; i < 1000; ++i) {
            const Vec3 w = map.sample(rng.next_2d());
            ASSERT_NEAR(length(w), 1, 1e-5);
            ASSERT_EQ(map.radiance(w), Rgb(3));
            ASSERT_GT(map.pdf(w), 0);
        }
    }
    const EnvironmentMap black(std::vector<Rgb>(8), 4, 2);
    EXPECT_EQ(black.mean(), Rgb());
    EXPECT_EQ(black.pdf({0, 0, 1}), 0);
}

TEST(EnvironmentMap, NegativeTexelsAreBlack) {
    const TemporaryImage image({Rgb(-5), Rgb(1), Rgb(1), Rgb(1)}, 2, 2);
    Warnings warnings;
    const EnvironmentMap map = EnvironmentMap::read(image.path(), {}, warnings);
    EXPECT_NEAR(luminance(map.mean()), 0.75, 1e-6);
}

TEST(EnvironmentMap, TexelsBeyondMeasureDoNoHarm) {
    const TemporaryImage image({Rgb(3e38f), Rgb(1), Rgb(1), Rgb(3e38f)}, 2, 2);
    Warnings warnings;
    const EnvironmentMap map = EnvironmentMap::read(image.path(), {}, warnings);
    Rng rng(4);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 w = map.sample(rng.next_2d());
        ASSERT_NEAR(length(w), 1, 1e-5);
        ASSERT_TRUE(std::isfinite(map.pdf(w)) && std::isfinite(map.radiance(w).g));
    }
    EXPECT_TRUE(std::isfinite(map.mean().g));
    // Directions that are not numbers are looked up somewhere.
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const Vec3 w : {Vec3{nan, nan, nan}, Vec3{kInfinity, 0, 0}})
        EXPECT_TRUE(std::isfinite(map.radiance(w).g));
}

TEST(EnvironmentMap, RefusesOtherShapesWithThePlaceInTheScene) {
    const TemporaryImage image(std::vector<Rgb>(12), 4, 3);
    const SourceLocation where{std::make_shared<const std::string>("sky.pbrt"), 7, 3};
    Warnings warnings;
    try {
        EnvironmentMap::read(image.path(), where, warnings);
        FAIL() << "accepted";
    } catch (const Error& e) {
        const std::string text = e.what();
        EXPECT_EQ(e.kind(), ErrorKind::scene);
        EXPECT_EQ(text.find("sky.pbrt:7:3"), 0u) << text;
        EXPECT_NE(text.find("4 x 3"), std::string::npos) << text;
        EXPECT_NE(text.find("expected"), std::string::npos) << text;
    }
    EXPECT_THROW(EnvironmentMap::read("/nonexistent.exr", where, warnings), Error);
}

TEST(Environment, TheTransformTurnsTheImage) {
    // The map is bright around +x of light space.
    const TemporaryImage image(
        texels_of(64, 32, [](Vec3 w) { return Rgb(w.x > 0.9f ? 10.0f : 1.0f); }), 64, 32);
    const Environment turned = environment(image_light(image), Transform::rotate(90, {0, 0, 1}));
    EXPECT_NEAR(turned.sky({0, 1, 0}).r, 10, 1e-4);
    EXPECT_NEAR(turned.sky({1, 0, 0}).r, 1, 1e-4);
    const Environment mirrored = environment(image_light(image), Transform::scale(-1, 1, 1));
    EXPECT_NEAR(mirrored.sky({-1, 0, 0}).r, 10, 1e-4);
}

TEST(Environment, IlluminanceScalesTheImage) {
    const TemporaryImage image(texels_of(64, 64, [](Vec3 w) { return Rgb(1 + w.z, 2, 0.5f); }), 64,
                               64);
    InfiniteLight light = image_light(image);
    light.radiance = Rgb(0.5f, 1, 2);
    light.illuminance = 1000.0f;
    const Environment e = environment(light);
    Rng rng(4);
    double sum = 0;
    constexpr int kSamples = 100000;
    for (int i = 0; i < kSamples; ++i)
        sum += double(luminance(e.sky(square_to_cosine_hemisphere(rng.next_2d())))) * double(kPi);
    EXPECT_NEAR(sum / kSamples, 1000, 5);
}

// ---- Spectrum

/// The square of side 2 at z = 1 around the z axis, that lets light through downwards.
InfiniteLight behind_a_square(InfiniteLight light) {
    light.portal = {{{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}}};
    return light;
}

TEST(Environment, LightComesThroughThePortalAlone) {
    const TemporaryImage image(sky_with_sun(64, 32, 9, 3, 50), 64, 32);
    const Environment open = environment(image_light(image)),
                      light = environment(behind_a_square(image_light(image)));
    Rng rng(8);
    int seen = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec2 a = rng.next_2d(), b = rng.next_2d();
        const Vec3 p{4 * a.x - 2, 4 * a.y - 2, 4 * b.x - 2}, w = square_to_sphere(rng.next_2d());
        const float t = (1 - p.z) / w.z;
        const Vec3 q = p + w * t;
        const bool expected = t > 0 && w.z > 0 && std::max(std::abs(q.x), std::abs(q.y)) < 1;
        if (std::abs(std::max(std::abs(q.x), std::abs(q.y)) - 1) < 1e-4f) continue;
        ASSERT_EQ(light.radiance(p, w), expected ? open.sky(w) : Rgb()) << i;
        ASSERT_EQ(light.pdf(p, {}, w) > 0, expected) << i;
        seen += expected;
    }
    EXPECT_GT(seen, 500);
    EXPECT_EQ(light.irradiance({0, 0, 1.001f}, {}), 0);
    EXPECT_EQ(light.pdf({0, 0, 3}, {}, {0, 0, 1}), 0);
}

TEST(Environment, PortalsAreSampledByWhatComesThrough) {
    // The sun is above: of a map that is even else, and of which a portal shows one part, samples
    // find what shines there.
    const auto sky = [](Vec3 w) { return w.z > 0.97f ? Rgb(100) : Rgb(0.1f, 0.2f, 0.3f); };
    const TemporaryImage image(texels_of(256, 128, sky), 256, 128);
    const Environment light = environment(behind_a_square(image_light(image)));
    Rng rng(9);
    for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{0.3f, -0.4f, -2}, Vec3{2, 1, 0}}) {
        double sum = 0, square = 0;
        constexpr int kSamples = 4000;
        for (int i = 0; i < kSamples; ++i) {
            const Vec3 w = light.direction(p, {}, light.begin_draw(rng.next_2d()));
            const auto sight = light.look(p, {}, w);
            const double v =
                sight.pdf > 0
                    ? (sight.radiance.r + sight.radiance.g + sight.radiance.b) / 3.0 / sight.pdf
                    : 0;
            sum += v;
            square += v * v;
        }
        const double mean = sum / kSamples;
        EXPECT_NEAR(mean / light.irradiance(p, {}), 1, 0.02) << p.x;
        EXPECT_LT(square / kSamples / (mean * mean) - 1, 0.05) << p.x;
    }
}

TEST(EnvironmentSpectrum, UniformLightHasNone) {
    const Environment e = environment(InfiniteLight{});
    const EnvironmentSpectrum spectrum(e);
    EXPECT_FALSE(spectrum.varies());
    const AngularCovariance a = spectrum.at(normalize(Vec3{1, 2, 3}));
    EXPECT_EQ(a.a11, 0);
    EXPECT_EQ(a.a12, 0);
    EXPECT_EQ(a.a22, 0);
}

/// `cycles` waves around the pole.
std::vector<Rgb> waves(int width, int height, float cycles) {
    return texels_of(width, height, [cycles](Vec3 w) {
        return Rgb(1 + 0.5f * std::sin(cycles * std::atan2(w.y, w.x)));
    });
}

TEST(EnvironmentSpectrum, WavesAroundThePole) {
    for (const int width : {512, 256}) {
        const TemporaryImage image(waves(width, 256, 16), width, 256);
        const Environment e = environment(image_light(image));
        const EnvironmentSpectrum spectrum(e);
        for (const float theta : {kPi / 2, kPi / 4}) {
            // The texels have sixteen waves around a circle of circumference 2 pi sin(theta); a
            // structure tensor counts a single frequency f as up to 2 f^2.
            const float f = 16 / (2 * kPi * std::sin(theta));
            const AngularCovariance a = spectrum.at(from_angles(theta, 1.3f));
            EXPECT_GT(a.a11, 0.7f * f * f) << theta;
            EXPECT_LT(a.a11, 3.0f * f * f) << theta;
            EXPECT_LT(a.a22, 0.3f * a.a11) << theta;
            // x points along increasing phi, z along the light's way.
            EXPECT_LT(distance(a.tangent.x, Vec3{-std::sin(1.3f), std::cos(1.3f), 0}), 1e-5f);
            EXPECT_LT(
                distance(a.tangent.y, Vec3{std::cos(theta) * std::cos(1.3f),
                                           std::cos(theta) * std::sin(1.3f), -std::sin(theta)}),
                1e-5f);
        }
    }
}

TEST(EnvironmentSpectrum, TurnsWithTheTransformAndStaysFiniteAtThePoles) {
    const TemporaryImage image(waves(256, 128, 12), 256, 128);
    const Transform turn = Transform::rotate(70, {1, 0.3f, -2});
    const Environment still = environment(image_light(image)),
                      turned = environment(image_light(image), turn);
    const EnvironmentSpectrum spectrum(still), of_turned(turned);
    const Vec3 w = from_angles(1.1f, 2.7f);
    const AngularCovariance a = spectrum.at(w), b = of_turned.at(normalize(turn.vector(w)));
    EXPECT_NEAR(b.a11, a.a11, 1e-2f * a.a11);
    EXPECT_LT(distance(b.tangent.x, turn.vector(a.tangent.x)), 1e-5f);
    for (const Vec3 pole : {Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
        const AngularCovariance c = spectrum.at(pole);
        EXPECT_TRUE(std::isfinite(c.a11) && std::isfinite(c.a12) && std::isfinite(c.a22));
    }
}

TEST(EnvironmentSpectrum, SeveralLightsAreAveragedByRadiance) {
    const TemporaryImage image(waves(256, 128, 12), 256, 128);
    LightScene one, both;
    one.add_light(image_light(image));
    both.add_light(image_light(image),
                   Transform::rotate(90, {0, 0, 1}));  // waves of the same phase
    both.add_light(InfiniteLight{.radiance = Rgb(2), .image = {}, .illuminance = {}});
    for (LightScene* s : {&one, &both}) s->build_with_spectra();
    const Vec3 w = from_angles(1.2f, 0.4f);
    const SourceSpectrum a = one.spectra->environment_spectrum(w),
                         b = both.spectra->environment_spectrum(w);
    EXPECT_EQ(a.kind, SourceSpectrum::Kind::environment);
    ASSERT_GT(a.a11, 0);
    const float l = luminance(one.lights->environment({}, w));
    EXPECT_NEAR(b.a11, a.a11 * l / (l + 2), 0.02f * a.a11);
}

TEST(EnvironmentMap, DrawsInStepsWhatItDrawsAtOnce) {
    const auto shade = [](Vec3 w) { return Rgb{1 + w.x, 1 + w.y * w.y, std::exp(3 * w.z)}; };
    for (const int width : {32, 64}) {
        const EnvironmentMap map(texels_of(width, 32, shade), width, 32);
        Rng rng(3);
        for (int i = 0; i < 10000; ++i) {
            const Vec2 u = rng.next_2d();
            EnvironmentMap::Draw draw = map.begin_draw(u);
            map.choose_texel(draw);
            ASSERT_EQ(map.direction(draw), map.sample(u));
        }
    }
}

}  // namespace
}  // namespace covtrace
