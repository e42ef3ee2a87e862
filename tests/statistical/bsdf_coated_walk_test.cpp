/// The closed form of the coated diffuse model against a random walk between coat and base.
///
/// The walk is written from the model's description, with its own interface: normals sampled from
/// the whole distribution (Walter et al. 2007, equations 35 and 36), Smith masking by tangents,
/// complex Fresnel, all in double. It shares no code with src/shading but the random numbers.
#include <gtest/gtest.h>

#include <array>
#include <complex>
#include <cstdio>

#include "bsdf/coat_table.h"
#include "core/rng.h"

namespace covtrace {
namespace {

struct Direction {
    double x = 0, y = 0, z = 1;
};
double dot(const Direction& a, const Direction& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// A coat of index `eta` over a Lambertian base; alpha_x = alpha_y = 0 is smooth.
struct Layers {
    double eta = 1.5, alpha_x = 0, alpha_y = 0, thickness = 0.01;
    int bounces = 5;
};

double fresnel(double cos_i, double eta) {
    const std::complex<double> cos_t =
        std::sqrt(std::complex<double>(1 - (1 - cos_i * cos_i) / (eta * eta)));
    return (std::norm((eta * cos_i - cos_t) / (eta * cos_i + cos_t)) +
            std::norm((cos_i - eta * cos_t) / (cos_i + eta * cos_t))) /
           2;
}

double smith_lambda(const Layers& l, const Direction& w) {
    const double tan2 =
        (l.alpha_x * l.alpha_x * w.x * w.x + l.alpha_y * l.alpha_y * w.y * w.y) / (w.z * w.z);
    return (std::sqrt(1 + tan2) - 1) / 2;
}

/// Follows light along `d` to the interface and beyond; `weight` takes the share that single
/// scattering keeps.
void meet_interface(const Layers& l, Direction& d, double& weight, Rng& rng) {
    const bool from_above = d.z < 0;
    const double eta = from_above ? l.eta : 1 / l.eta, side = from_above ? 1 : -1;
    Direction m{0, 0, 1};
    if (l.alpha_x > 0) {
        const double u = rng.next_float(), phi = 2 * M_PI * rng.next_float();
        const double radius = std::sqrt(u / (1 - u));
        const Direction slope{l.alpha_x * radius * std::cos(phi),
                              l.alpha_y * radius * std::sin(phi), 1};
        const double length = std::sqrt(dot(slope, slope));
        m = {slope.x / length, slope.y / length, 1 / length};
    }
    m = {m.x * side, m.y * side, m.z * side};
    const double cos_i = -dot(d, m);
    if (cos_i <= 0) {
        weight = 0;
        return;
    }
    const double f = fresnel(cos_i, eta);
    const Direction before = d;
    const bool reflects = rng.next_float() < f;
    if (reflects) {
        d = {d.x + 2 * cos_i * m.x, d.y + 2 * cos_i * m.y, d.z + 2 * cos_i * m.z};
    } else {
        const double cos_t = std::sqrt(1 - (1 - cos_i * cos_i) / (eta * eta));
        const double along = cos_i / eta - cos_t;
        d = {d.x / eta + along * m.x, d.y / eta + along * m.y, d.z / eta + along * m.z};
    }
    if (reflects ? d.z * side <= 0 : d.z * side >= 0) {
        weight = 0;
        return;
    }
    if (l.alpha_x > 0)
        weight *=
            cos_i / (1 + smith_lambda(l, before) + smith_lambda(l, d)) / std::abs(before.z * m.z);
}

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
        Direction d{-wo.x, -wo.y, -wo.z};
        double weight = 1.0 / walks;
        meet_interface(l, d, weight, rng);
        if (weight == 0) continue;
        if (d.z > 0) {
            result.coat += weight;
            continue;
        }
        for (int bounce = 0; bounce < l.bounces && weight > 0; ++bounce) {
            weight *= std::exp(-l.thickness / -d.z);
            const double cos2 = rng.next_float(), phi = 2 * M_PI * rng.next_float();
            const double sine = std::sqrt(1 - cos2);
            d = {sine * std::cos(phi), sine * std::sin(phi), std::sqrt(cos2)};
            if (d.z == 0) break;
            weight *= std::exp(-l.thickness / d.z);
            meet_interface(l, d, weight, rng);
            if (weight > 0 && d.z > 0) {
                result.base[static_cast<size_t>(bounce)] += weight;
                result.base_by_exit[static_cast<size_t>(std::min(d.z * d.z, 0.9999999) * kBins)] +=
                    weight * std::pow(0.8, bounce + 1);
                break;
            }
        }
    }
    return result;
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
        const WalkResult reference =
            walk({1.5, alpha, alpha, 0.01}, {wo.x, wo.y, wo.z}, 400000, 77);
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
    const WalkResult reference = walk({1.5, alpha, alpha, 0.01}, {wo.x, wo.y, wo.z}, 800000, 78);
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
                    walk({1.5, alpha_x, alpha_y, 0.01}, {wo.x, wo.y, wo.z}, 200000, 79);
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
