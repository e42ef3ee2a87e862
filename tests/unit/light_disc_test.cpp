#include <gtest/gtest.h>

#include <cmath>

#include "core/rng.h"
#include "core/warp.h"
#include "light/distant_disc.h"
#include "light_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

DistantLight sun(float angle) {
    return {.radiance = Rgb(3, 2, 1), .direction = {0, 0, 1}, .angle = angle};
}

/// Solid angle of the disc with the given full angle in degrees, without cancellation.
double solid_angle(double degrees) {
    return 4 * M_PI * std::pow(std::sin(degrees / 4 * M_PI / 180), 2);
}

class DistantDiscs : public testing::TestWithParam<float> {};

TEST_P(DistantDiscs, DensityIntegratesToOne) {
    const DistantDisc disc(sun(GetParam()), normalize(Vec3{1, 2, -3}));
    EXPECT_NEAR(double(disc.look(disc.centre()).pdf) * solid_angle(GetParam()), 1, 1e-6);
}

/// A surface that faces the disc gets its irradiance, however wide it is.
TEST_P(DistantDiscs, GiveTheirIrradiance) {
    const DistantDisc disc(sun(GetParam()), normalize(Vec3{1, 2, -3}));
    constexpr int kSteps = 300;
    double sum = 0;
    int lost = 0;
    for (int i = 0; i < kSteps; ++i)
        for (int k = 0; k < kSteps; ++k) {
            const Vec3 w = disc.sample({(float(i) + 0.5f) / kSteps, (float(k) + 0.5f) / kSteps});
            const EnvironmentMap::Sight sight = disc.look(w);
            if (sight.pdf > 0)
                sum += double(sight.radiance.r) * double(dot(w, disc.centre())) / sight.pdf;
            else
                ++lost;
        }
    // Directions next to the rim round to others outside of it: a thousandth of the smallest disc.
    const double most = 6e-8 * 180 / M_PI / GetParam() * 4;
    EXPECT_LE(double(lost), kSteps * kSteps * most + 2);
    EXPECT_NEAR(sum / (kSteps * kSteps) / 3, 1, most + 1e-4);
}

TEST_P(DistantDiscs, EndAtTheirRim) {
    const DistantDisc disc(sun(GetParam()), {0, 0, 1});
    const double rim = double(GetParam()) / 2 * M_PI / 180, slack = 1e-3 * rim;
    const auto at = [](double angle, double phi) {
        return Vec3{float(std::sin(angle) * std::cos(phi)), float(std::sin(angle) * std::sin(phi)),
                    float(std::cos(angle))};
    };
    for (double phi = 0; phi < 6; phi += 0.5) {
        EXPECT_TRUE(disc.contains(at(rim - slack, phi)));
        EXPECT_FALSE(disc.contains(at(rim + slack, phi)));
        EXPECT_EQ(disc.look(at(rim + slack, phi)).radiance, Rgb(0));
    }
}

INSTANTIATE_TEST_SUITE_P(Angles, DistantDiscs,
                         testing::Values(0.01f, 0.526f, 5.0f, 60.0f, 150.0f, 180.0f));

TEST(DistantDisc, IsChosenForSurfacesBesideIt) {
    const DistantDisc narrow(sun(0.5f), {0, 0, 1}), wide(sun(180), {0, 0, 1});
    EXPECT_FLOAT_EQ(narrow.choice_weight_at({0, 0, 1}), 2);
    EXPECT_FLOAT_EQ(narrow.choice_weight_at({}), 2);
    EXPECT_NEAR(narrow.choice_weight_at({1, 0, 0}), 0.04f, 1e-6f);
    EXPECT_NEAR(wide.choice_weight_at({1, 0, 0}), 0.5f, 1e-6f);
}

TEST(DistantDisc, IsPartOfTheSkyThatRaysFind) {
    LightScene s;
    s.add_light(sun(10));
    s.build();
    EXPECT_TRUE(s.lights->has_environment());
    EXPECT_FALSE(s.lights->has_sky());
    EXPECT_TRUE(s.lights->is_in_disc({0, 0, 1}));
    EXPECT_FALSE(s.lights->is_in_disc({0, 1, 0}));
    EXPECT_EQ(s.lights->environment({}, {0, 1, 0}), Rgb(0));
    EXPECT_GT(s.lights->environment({}, {0, 0, 1}).r, 0);
    // A tenth of a degree is a delta light's neighbour: both give the same power
    LightScene delta;
    delta.add_light(sun(0));
    delta.build();
    EXPECT_FALSE(delta.lights->has_environment());
    EXPECT_EQ(delta.lights->total_power(), s.lights->total_power());
}

TEST(DistantDisc, LeavesHolesWhereTheCameraSeesNoSky) {
    LightScene s;
    s.add_light(sun(10));
    InfiniteLight sky;
    sky.visible_to = kEveryRay & RayKinds(~set_of(RayKind::camera));
    s.add_light(sky);
    s.build();
    EXPECT_TRUE(s.lights->has_sky());
    EXPECT_FALSE(s.lights->has_sky_for(RayKind::camera));
    EXPECT_TRUE(s.lights->has_sky_for(RayKind::glossy));
}

TEST(DistantDisc, IsHiddenFromSomeRays) {
    LightScene s;
    DistantLight light = sun(10);
    light.visible_to = kEveryRay & RayKinds(~set_of(RayKind::camera));
    s.add_light(light);
    s.build();
    const Vec3 up{0, 0, 1};
    EXPECT_EQ(s.lights->environment({}, up, RayKind::camera), Rgb(0));
    EXPECT_GT(s.lights->environment({}, up, RayKind::glossy).r, 0);
    EXPECT_TRUE(s.lights->sample({}, up, 0, 0.5f, {0.5f, 0.5f}).has_value());
}

/// A part of the sky that is known to be seen leaves the disc its own samples and their density.
TEST(DistantDisc, IsSampledBesideGuides) {
    LightScene s;
    s.add_light(InfiniteLight{.radiance = Rgb(2)});
    s.add_light(DistantLight{.radiance = Rgb(5), .direction = {0.6f, 0, 0.8f}, .angle = 3});
    s.build();
    SkyCell cell;
    std::array<double, SkyCell::kBlocks> weights{};
    weights[SkyCell::block({0, 0, 1})] = 1;
    cell.set_weights(weights);
    cell.share = 0.8f;
    Rng rng(3);
    double sum = 0, squares = 0;
    int in_disc = 0;
    constexpr int kSamples = 200000;
    for (int i = 0; i < kSamples; ++i) {
        const float u = rng.next_float();
        const auto l = s.lights->finish_draw({}, {0, 0, 1}, 0, u, {rng.next_2d(), {}, 0}, &cell);
        if (!l) continue;
        ASSERT_NEAR(l->pdf / s.lights->sky({}, {0, 0, 1}, l->wi, &cell).pdf, 1, 1e-4);
        in_disc += s.lights->is_in_disc(l->wi) ? 1 : 0;
        const double y = double(l->radiance.r) * double(std::max(0.0f, l->wi.z)) / l->pdf;
        sum += y, squares += y * y;
    }
    const double mean = sum / kSamples;
    const double error = std::sqrt((squares / kSamples - mean * mean) / kSamples);
    // 5 * 0.8 from the disc and 2 pi from the sky; 4.5 standard errors: false alarms of 7e-6
    EXPECT_NEAR(mean, 4 + 2 * double(kPi), 4.5 * error);
    EXPECT_GT(in_disc, kSamples / 20);
}

TEST(DistantDisc, HasTheSpectrumOfItsSizeAndItsRimWhereItIsSeen) {
    LightScene s;
    s.add_light(sun(10));
    s.build_with_spectra();
    const float radius = 5 * kPi / 180, place = 4 * kPi / 180;
    const Vec3 w{std::sin(place), 0, std::cos(place)};
    const SourceSpectrum inside = s.spectra->environment_spectrum(w);
    EXPECT_NEAR(inside.a11 * sqr(kPi * radius), 1, 1e-4);
    EXPECT_NEAR(inside.a22 * sqr(kPi * radius), 1, 1e-4);
    EXPECT_EQ(inside.border_distance, kInfinity);
    const SourceSpectrum seen = s.spectra->environment_spectrum(w, RayKind::camera);
    EXPECT_NEAR(seen.border_distance, radius - place, 1e-5f);
    const Vec3 towards =
        seen.tangent.x * seen.border_direction.x + seen.tangent.y * seen.border_direction.y;
    EXPECT_NEAR(std::abs(dot(towards, normalize(Vec3{0, 0, 1} - w * w.z))), 1, 1e-4f);
    EXPECT_EQ(s.spectra->environment_spectrum({0, 1, 0}).a11, 0);
    EXPECT_FALSE(s.spectra->has_even_sky());
}

TEST(DistantDisc, HasNoRimForRaysThatDoNotMeetIt) {
    LightScene s;
    DistantLight hidden = sun(10);
    hidden.visible_to = kEveryRay & ~set_of(RayKind::camera);
    s.add_light(hidden);
    s.build_with_spectra();
    EXPECT_EQ(s.spectra->environment_spectrum({0, 0, 1}, RayKind::camera).border_distance,
              kInfinity);
    EXPECT_NEAR(s.spectra->environment_spectrum({0, 0, 1}, RayKind::glossy).border_distance,
                5 * kPi / 180, 1e-5f);
}

}  // namespace
}  // namespace covtrace
