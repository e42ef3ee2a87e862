/// The closed form of the coated diffuse model against a random walk between coat and base.
///
/// The walk is that of layer_walk.h, which shares no code with src/bsdf but the random numbers.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "bsdf/coat_table.h"
#include "core/rng.h"
#include "layer_walk.h"

namespace covtrace {
namespace {

constexpr int kBins = 8;
struct WalkResult {
    double coat = 0;
    /// Energy from the base by the number of reflections at it (for rho = 1), and by cos^2 of the
    /// exit.
    std::array<double, 5> base{};
    std::array<double, kBins> base_by_exit{};  ///< for rho = 0.8
    double albedo(double rho) const {
        double sum = coat, power = rho;
        for (double b : base) {
            sum += power * b;
            power *= rho;
        }
        return sum;
    }
};

WalkResult walk(const Layers& l, const Direction& wo, int walks, uint64_t seed) {
    Rng rng(seed);
    WalkResult result;
    for (int i = 0; i < walks; ++i) {
        const auto light = follow_light(l, {-wo.x, -wo.y, -wo.z}, rng);
        if (!light) continue;
        const double weight = light->weight / walks;
        if (light->at_base == 0) {
            result.coat += weight;
            continue;
        }
        result.base[static_cast<size_t>(light->at_base - 1)] += weight;
        result.base_by_exit[static_cast<size_t>(std::min(light->way.z * light->way.z, 0.9999999) *
                                                kBins)] += weight * std::pow(0.8, light->at_base);
    }
    return result;
}

/// A coat of index 1.5 on a Lambertian base, met five times at most.
Layers on_diffuse(float alpha_x, float alpha_y) {
    Layers l;
    l.coat = {alpha_x, alpha_y};
    l.bounces = 5;
    return l;
}

const CoatTable& coat() {
    static const CoatTable table(1.5f, 0.01f);
    return table;
}

Vec3 at_degrees(double theta, double phi = 0) {
    theta *= M_PI / 180;
    return {static_cast<float>(std::sin(theta) * std::cos(phi)),
            static_cast<float>(std::sin(theta) * std::sin(phi)),
            static_cast<float>(std::cos(theta))};
}

class CoatedWalk : public testing::TestWithParam<float> {};
INSTANTIATE_TEST_SUITE_P(Alphas, CoatedWalk, testing::Values(0.0f, 0.05f, 0.15f, 0.5f));

// The comparison is deterministic in effect: 400000 walks leave a standard error below 0.2 % of
// each albedo, so that the tolerance of 1 % lies five of them away.
TEST_P(CoatedWalk, DirectionalAlbedoAgrees) {
    const float alpha = GetParam();
    for (double degrees : {0.0, 30.0, 60.0, 75.0, 85.0}) {
        const Vec3 wo = at_degrees(degrees);
        const WalkResult reference = walk(on_diffuse(alpha, alpha), {wo.x, wo.y, wo.z}, 400000, 77);
        for (float rho : {0.2f, 0.8f}) {
            const double expected = reference.albedo(rho);
            const double closed =
                albedo(Bsdf(make_coated_diffuse(coat(), reflectance_powers(Rgb(rho)), alpha, alpha,
                                                5)),
                       wo)
                    .g;
            std::printf(
                "alpha %.3f, %2.0f degrees, rho %.1f: walk %.4f, closed form %.4f (%+.2f %%)\n",
                static_cast<double>(alpha), degrees, static_cast<double>(rho), expected, closed,
                100 * (closed / expected - 1));
            EXPECT_NEAR(closed / expected, 1, 0.01) << degrees << " degrees, rho " << rho;
        }
    }
}

// The directions of the base's light check the transmission on the way out and, with the albedo,
// reciprocity.
TEST_P(CoatedWalk, ExitDirectionsAgree) {
    const float alpha = GetParam();
    const Vec3 wo = at_degrees(45);
    const WalkResult reference = walk(on_diffuse(alpha, alpha), {wo.x, wo.y, wo.z}, 800000, 78);
    const Bsdf coated = make_coated_diffuse(coat(), reflectance_powers(Rgb(0.8f)), alpha, alpha, 5);
    for (int bin = 0; bin < kBins; ++bin) {
        constexpr int kSteps = 400;
        double sum = 0;
        for (int i = 0; i < kSteps; ++i) {
            const double cos2 = (bin + (i + 0.5) / kSteps) / kBins, cosine = std::sqrt(cos2);
            const Vec3 wi{static_cast<float>(std::sqrt(1 - cos2)), 0, static_cast<float>(cosine)};
            // d cos = d cos^2 / (2 cos); the base's lobe is the same for all azimuths.
            const LobeShares shares = lobe_shares(coated, wo, wi, eval(coated, wo, wi));
            sum += shares.lobes[0].value.g / cosine * M_PI / kSteps / kBins;
        }
        EXPECT_NEAR(sum / reference.base_by_exit[static_cast<size_t>(bin)], 1, 0.02)
            << "bin " << bin;
    }
}

// The error of anisotropic coats is bounded, as the tables are isotropic: for moderate anisotropy
// it stays below 1.5 %; a ratio of five reaches 4.5 % at 80 degrees.
TEST(CoatedWalkAnisotropic, AlbedoAgreesWithinFivePercent) {
    for (auto [alpha_x, alpha_y] : {std::pair{0.05f, 0.2f}, {0.1f, 0.5f}})
        for (double degrees : {20.0, 60.0, 80.0})
            for (double phi : {0.0, M_PI / 4, M_PI / 2}) {
                const Vec3 wo = at_degrees(degrees, phi);
                const WalkResult reference =
                    walk(on_diffuse(alpha_x, alpha_y), {wo.x, wo.y, wo.z}, 200000, 79);
                const Bsdf coated =
                    make_coated_diffuse(coat(), reflectance_powers(Rgb(0.5f)), alpha_x, alpha_y, 5);
                const double closed = albedo(coated, wo).g;
                std::printf(
                    "alpha %.2f x %.2f, %2.0f degrees, azimuth %.2f: walk %.4f, closed form %.4f\n",
                    static_cast<double>(alpha_x), static_cast<double>(alpha_y), degrees, phi,
                    reference.albedo(0.5), closed);
                EXPECT_NEAR(closed / reference.albedo(0.5), 1, 0.05);
            }
}

}  // namespace
}  // namespace covtrace
