#include "core/noise.h"

#include <gtest/gtest.h>

#include "core/rng.h"
#include "texture/graph.h"
#include "texture/spectra.h"

namespace covtrace {
namespace {

/// A scene with a single texture.
struct OneTexture {
    SceneDescription scene;
    std::optional<TextureStore> store;
    std::optional<TextureSpectra> spectra;

    template <typename Texture>
    explicit OneTexture(const Texture& texture, std::vector<Rgb> constants = {}) {
        scene.textures.push_back({"t", true, texture, {}});
        for (const Rgb& value : constants)
            scene.textures.push_back({"", true, ConstantTexture{value}, {}});
        store.emplace(scene);
        spectra.emplace(*store);
    }
    Rgb at(Vec3 p) const { return store->eval(0, {{p.x, p.y}, p}); }
};

NoiseTexture noise_of(NoiseTexture::Kind kind) {
    NoiseTexture t;
    t.kind = kind;
    return t;
}

Vec3 anywhere(Rng& rng) {
    const Vec2 a = rng.next_2d(), b = rng.next_2d();
    return 200 * Vec3{a.x, a.y, b.x} - Vec3{100, 100, 100};
}

TEST(Noise, HasTheValuesOfPbrt) {
    // The values follow the formulas of pbrt-v4's util/noise.cpp in double precision.
    EXPECT_NEAR(noise({1.3f, 2.7f, -3.2f}), 0.2848972f, 2e-6f);
    EXPECT_NEAR(noise({100.25f, -50.5f, 0.125f}), 0.5810798f, 2e-6f);
    EXPECT_NEAR(noise({0.5f, 0.5f, 0.5f}), -0.1250000f, 2e-6f);
    EXPECT_NEAR(fractal_noise({1.3f, 2.7f, -3.2f}, 0, {4, 0.6f}), 0.6841485f, 1e-5f);
    EXPECT_NEAR(fractal_noise({1.3f, 2.7f, -3.2f}, 0.1f, {8, 0.5f}), 0.4255668f, 1e-5f);
    EXPECT_NEAR(turbulence({1.3f, 2.7f, -3.2f}, 0, {8, 0.5f}), 0.6365660f, 1e-5f);
    EXPECT_NEAR(turbulence({1.3f, 2.7f, -3.2f}, 0.1f, {8, 0.5f}), 0.5735700f, 1e-5f);
}

TEST(Noise, IsZeroAtWholeCoordinatesAndContinuous) {
    Rng rng(1);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 p = anywhere(rng);
        EXPECT_EQ(noise({std::floor(p.x), std::floor(p.y), std::floor(p.z)}), 0);
        EXPECT_NEAR(noise(p), noise(p + Vec3{1e-3f, -1e-3f, 1e-3f}), 0.02f);
    }
    for (const float far : {1e9f, 1e30f, kInfinity, std::numeric_limits<float>::quiet_NaN()})
        EXPECT_TRUE(std::isfinite(noise({far, 0.3f, -far})));
}

TEST(Noise, PixelsAsLargeAsCellsShowNone) {
    Rng rng(2);
    for (int i = 0; i < 100; ++i) {
        const Vec3 p = anywhere(rng);
        EXPECT_EQ(fractal_noise(p, 1, {}), 0);
        EXPECT_NEAR(turbulence(p, 1, {3, 0.5f}), 0.2f * (1 + 1 + 0.5f + 0.25f), 1e-6f);
        EXPECT_EQ(fractal_noise(p, 0, {0, 0.5f}), 0);
    }
}

TEST(Noise, EnergyIsThatOfItsValuesAndSlopes) {
    Rng rng(3);
    const Octaves octaves{3, 0.5f};
    double square = 0, slope = 0;
    constexpr int kSamples = 100000;
    for (int i = 0; i < kSamples; ++i) {
        const Vec3 p = anywhere(rng);
        constexpr float kStep = 2e-3f;
        Vec3 aside = p;
        aside[i % 3] += kStep;
        const float a = fractal_noise(p, 0, octaves), b = fractal_noise(aside, 0, octaves);
        square += sqr(double(a)) / kSamples;
        slope += sqr(double(b - a) / double(kStep) / (2 * double(kPi))) / kSamples;
    }
    const NoiseEnergy energy = noise_energy(0, octaves);
    EXPECT_NEAR(energy.all / square, 1, 0.03);
    EXPECT_NEAR(energy.slope / slope, 1, 0.03);
}

TEST(NoiseTextures, AreMadeAsInPbrt) {
    using Kind = NoiseTexture::Kind;
    const Vec3 p{1.3f, 2.7f, -3.2f};
    EXPECT_EQ(OneTexture(noise_of(Kind::fbm)).at(p).r, fractal_noise(p, 0, {}));
    EXPECT_EQ(OneTexture(noise_of(Kind::wrinkled)).at(p).r, turbulence(p, 0, {}));
    EXPECT_NEAR(OneTexture(noise_of(Kind::windy)).at(p).r,
                std::abs(fractal_noise(0.1f * p, 0, {3, 0.5f})) * fractal_noise(p, 0, {6, 0.5f}),
                1e-6f);
    NoiseTexture moved = noise_of(Kind::fbm);
    moved.texture_from_world = Transform::translate({1, 2, 3});
    EXPECT_NEAR(OneTexture(moved).at(p).r, fractal_noise(p + Vec3{1, 2, 3}, 0, {}), 1e-5f);
}

TEST(NoiseTextures, MarbleRunsThroughItsColours) {
    NoiseTexture marble = noise_of(NoiseTexture::Kind::marble);
    marble.variation = 0;
    marble.scale = 2;
    const OneTexture t(marble);
    // The first colour is at sin = -1, the last at sin = 1; both times 1.5.
    const Rgb first = t.at({0, -kPi / 4, 0}), last = t.at({0, kPi / 4, 0});
    for (const Rgb& c : {first, last}) {
        EXPECT_NEAR(c.r, 0.87f, 1e-5f);
        EXPECT_NEAR(c.b, 0.9f, 1e-5f);
    }
    // In the middle of the fifth of six segments a Bezier curve passes between four colours.
    EXPECT_NEAR(t.at({0, std::asin(0.5f) / 2, 0}).r,
                1.5f * (0.6f + 3 * 0.58f + 3 * 0.58f + 0.2f) / 8, 1e-4f);
    marble.variation = 0.2f;
    const OneTexture bent(marble);
    EXPECT_NEAR(bent.store->mean(0).r, 0.8f, 0.02f);
    EXPECT_NEAR(bent.store->mean(0).b, 0.84f, 0.02f);
}

TEST(NoiseTextures, MarbleIsFilteredWhicheverWayItRuns) {
    // A pixel of a cell leaves no octave: the veins are straight.
    for (const float scale : {-1.0f, 1.0f}) {
        NoiseTexture marble = noise_of(NoiseTexture::Kind::marble), straight = marble;
        marble.scale = straight.scale = scale;
        marble.variation = 5;
        straight.variation = 0;
        TexturePoint at{{}, {1.3f, 2.7f, -3.2f}};
        at.footprint.dp = {Vec3{1, 0, 0}, Vec3{0, 1, 0}};
        EXPECT_EQ(OneTexture(marble).store->eval(0, at), OneTexture(straight).store->eval(0, at));
    }
}

TEST(NoiseTextures, AbsurdParametersMakeFiniteValues) {
    using Kind = NoiseTexture::Kind;
    constexpr float kHuge = 3e38f;
    for (const Kind kind : {Kind::fbm, Kind::wrinkled, Kind::windy, Kind::marble}) {
        NoiseTexture t = noise_of(kind);
        t.omega = t.scale = t.variation = kHuge;
        t.octaves = 64;
        for (const Vec3 p : {Vec3{1.3f, 2.7f, -3.2f}, Vec3{kHuge, 0, -kHuge}}) {
            const OneTexture one(t);
            EXPECT_TRUE(is_finite(one.at(p)));
            const SpatialCovariance2 c =
                one.spectra->uv_covariance(0, {{}, p}, {1, 0, 0}, {0, kHuge, 0}, 0.1f);
            EXPECT_TRUE(std::isfinite(c.ss + c.st + c.tt));
        }
    }
}

TEST(Dots, LieWithinTheirCells) {
    DotsTexture dots;
    dots.inside = 1;
    dots.outside = 2;
    const OneTexture t(dots, {Rgb(1), Rgb(0)});
    int found = 0;
    constexpr int kCells = 50;
    for (int j = 0; j < kCells; ++j)
        for (int i = 0; i < kCells; ++i) {
            const Vec2 cell{float(i), float(j)};
            const auto center = dot_center(cell);
            if (!center) {
                EXPECT_EQ(t.at({cell.x, cell.y, 0}), Rgb(0));
                continue;
            }
            ++found;
            EXPECT_LE(std::abs(center->x - cell.x) + kDotRadius, 0.5f + 1e-4f);
            EXPECT_LE(std::abs(center->y - cell.y) + kDotRadius, 0.5f + 1e-4f);
            EXPECT_EQ(t.at({center->x + 0.34f, center->y, 0}), Rgb(1));
            EXPECT_EQ(t.at({center->x, center->y - 0.36f, 0}), Rgb(0));
        }
    EXPECT_GT(found, kCells * kCells / 3);
    EXPECT_LT(found, kCells * kCells / 2);
}

TEST(Bilerp, HasItsValuesAtTheCorners) {
    BilerpTexture t;
    t.v00 = Rgb(1);
    t.v01 = Rgb(2);
    t.v10 = Rgb(3);
    t.v11 = Rgb(8);
    const OneTexture one(t);
    EXPECT_EQ(one.at({0, 0, 0}), Rgb(1));
    EXPECT_EQ(one.at({0, 1, 0}), Rgb(2));
    EXPECT_EQ(one.at({1, 0, 0}), Rgb(3));
    EXPECT_EQ(one.at({1, 1, 0}), Rgb(8));
    EXPECT_NEAR(one.at({0.5f, 0.5f, 0}).r, 3.5f, 1e-6f);
    EXPECT_NEAR(one.store->mean(0).r, 3.5f, 1e-3f);
}

SpatialCovariance2 covariance(const OneTexture& t, Vec3 p, float footprint) {
    return t.spectra->uv_covariance(0, {{p.x, p.y}, p}, {1, 0, 0}, {0, 1, 0}, footprint);
}

TEST(NoiseTextures, CovarianceIsTheSpectrumOfTheOctavesInView) {
    NoiseTexture t = noise_of(NoiseTexture::Kind::fbm);
    t.octaves = 1;
    const SpatialCovariance2 one = covariance(OneTexture(t), {1, 2, 3}, 0);
    EXPECT_NEAR(one.ss, 0.1747f, 1e-4f);
    EXPECT_NEAR(one.tt, one.ss, 1e-6f);
    EXPECT_NEAR(one.st, 0, 1e-6f);
    t.octaves = 8;
    const OneTexture all(t);
    EXPECT_GT(covariance(all, {1, 2, 3}, 0).ss, 4 * one.ss);
    EXPECT_LT(covariance(all, {1, 2, 3}, 0.1f).ss, 2 * one.ss);
    // The texture is twice as small and has twice the frequency.
    t.texture_from_world = Transform::scale(2, 2, 2);
    EXPECT_NEAR(covariance(OneTexture(t), {1, 2, 3}, 0).ss, 4 * covariance(all, {1, 2, 3}, 0).ss,
                1e-3f);
}

TEST(Dots, CovarianceIsLargeAcrossTheRim) {
    DotsTexture dots;
    dots.inside = 1;
    dots.outside = 2;
    const OneTexture t(dots, {Rgb(1), Rgb(0)});
    Vec2 cell{0, 0};
    while (!dot_center(cell)) cell.x += 1;
    const Vec2 c = *dot_center(cell);
    const SpatialCovariance2 at_rim = covariance(t, {c.x + kDotRadius - 0.01f, c.y, 0}, 0),
                             inside = covariance(t, {c.x + 0.1f, c.y, 0}, 0);
    EXPECT_GT(at_rim.ss, 100 * inside.ss);
    EXPECT_GT(at_rim.ss, 1000 * at_rim.tt);
}

}  // namespace
}  // namespace covtrace
