/// Hair against its formulas, written out in double precision, and against known integrals.
#include "bsdf/hair.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/rng.h"
#include "core/warp.h"

namespace covtrace {
namespace {

constexpr double kTurn = 2 * M_PI;

/// A_p M_p N_p summed, as Pharr, Jakob and Humphreys 2023, section 9.9, have it.
double formula(const HairShape& shape, double absorption, double h, Vec3 wo, Vec3 wi) {
    const double sin_o = wo.x, cos_o = std::sqrt(1 - sin_o * sin_o);
    const double sin_i = wi.x, cos_i = std::sqrt(1 - sin_i * sin_i);
    const double phi = std::atan2(wi.z, wi.y) - std::atan2(wo.z, wo.y);
    const double m = shape.beta_m, n = shape.beta_n, eta = shape.eta;
    const double root = 0.726 * m + 0.812 * m * m + 3.7 * std::pow(m, 20), v = root * root;
    const double first_m = m * (1 - shape.coat);
    const double first = 0.726 * first_m + 0.812 * first_m * first_m + 3.7 * std::pow(first_m, 20);
    const double variance[] = {first * first, v / 4, 4 * v, 4 * v};
    const double s = std::sqrt(M_PI / 8) * (0.265 * n + 1.194 * n * n + 5.372 * std::pow(n, 22));
    const double sin_gamma_t = h * cos_o / std::sqrt(eta * eta - sin_o * sin_o);
    const double gamma_o = std::asin(h), gamma_t = std::asin(sin_gamma_t);
    const double cos_theta_t = std::sqrt(1 - sin_o * sin_o / (eta * eta));
    const double passed = std::exp(-absorption * 2 * std::cos(gamma_t) / cos_theta_t);
    const double c = cos_o * std::cos(gamma_o), t = std::sqrt(1 - (1 - c * c) / (eta * eta));
    const double parallel = (eta * c - t) / (eta * c + t), across = (c - eta * t) / (c + eta * t);
    const double f = (parallel * parallel + across * across) / 2;
    const double twice = (1 - f) * (1 - f) * passed;
    const double shares[] = {f, twice, twice * passed * f,
                             twice * passed * f * passed * f / (1 - passed * f)};
    const double turns[] = {-2, 1, 4, 0};
    double sum = 0;
    for (int p = 0; p < 4; ++p) {
        const double tilt = turns[p] * double(shape.alpha) * M_PI / 180;
        const double theta = std::asin(sin_o) + tilt, w = variance[p];
        const double a = cos_i * std::abs(std::cos(theta)) / w, b = sin_i * std::sin(theta) / w;
        // For the sum of the logarithms, as neither factor is in range for small variances.
        const double log_i0 = a < 700 ? std::log(std::cyl_bessel_i(0.0, a))
                                      : a - 0.5 * std::log(kTurn * a) + std::log1p(1 / (8 * a));
        const double log_sinh = 1 / w + std::log1p(-std::exp(-2 / w)) - std::log(2);
        const double along = std::exp(log_i0 - b - log_sinh) / (2 * w);
        const double x =
            std::abs(std::remainder(phi - (2 * p * gamma_t - 2 * gamma_o + p * M_PI), kTurn));
        const double e = std::exp(-x / s), within = std::tanh(M_PI / (2 * s));
        const double about = p == 3 ? 1 / kTurn : e / (s * (1 + e) * (1 + e)) / within;
        sum += shares[p] * along * about;
    }
    return sum;
}

HairShape some_shape(Rng& rng) {
    HairShape shape;
    shape.beta_m = 0.05f + 0.95f * rng.next_float();
    shape.beta_n = 0.05f + 0.95f * rng.next_float();
    shape.alpha = 6 * rng.next_float() - 1;
    shape.eta = 1.1f + rng.next_float();
    shape.coat = rng.next_float() < 0.5f ? 0.0f : 0.5f * rng.next_float();
    return shape;
}

HairBsdf with_offset(HairBsdf b, float offset) {
    b.offset = offset;
    return b;
}

TEST(BsdfHair, AgreesWithTheFormulas) {
    Rng rng(5);
    for (int i = 0; i < 4000; ++i) {
        const HairShape shape = some_shape(rng);
        const float h = 1.98f * rng.next_float() - 0.99f;
        const Rgb absorption{rng.next_float(), 3 * rng.next_float(), 0};
        const HairBsdf b = with_offset(make_hair(shape, absorption), h);
        const Vec3 wo = square_to_sphere(rng.next_2d());
        Vec3 wi = square_to_sphere(rng.next_2d());
        // Sampled directions reach narrow lobes, others the rest.
        if (i % 2)
            if (const auto s = sample(b, wo, rng.next_float(), rng.next_2d())) wi = s->wi;
        const Rgb f = eval(b, wo, wi);
        for (int c = 0; c < 3; ++c) {
            const double expected = formula(shape, absorption[c], h, wo, wi);
            EXPECT_NEAR(f[c], expected, 1e-6 + 2e-3 * expected) << i;
        }
    }
}

TEST(BsdfHair, WhiteFurnace) {
    for (const float beta_m : {0.15f, 0.3f, 0.6f, 1.0f})
        for (const float beta_n : {0.2f, 0.5f, 1.0f})
            for (const float h : {-0.95f, 0.0f, 0.6f})
                for (const float sin_o : {-0.9f, 0.0f, 0.5f, 0.99f}) {
                    const HairBsdf b = with_offset(
                        make_hair({.beta_m = beta_m, .beta_n = beta_n, .alpha = 3}, Rgb(0)), h);
                    const float cos_o = std::sqrt(1 - sin_o * sin_o);
                    const Vec3 wo{sin_o, cos_o * 0.6f, cos_o * 0.8f};
                    // The sine and the angle about the strand are an equal-area map of the sphere.
                    constexpr int kSines = 512, kAngles = 96;
                    double light = 0, density = 0;
                    for (int i = 0; i < kSines * kAngles; ++i) {
                        const double x = 2 * (i % kSines + 0.5) / kSines - 1,
                                     phi = kTurn * (i / kSines + 0.5) / kAngles,
                                     r = std::sqrt(1 - x * x);
                        const BsdfValue value = eval_and_pdf(
                            Bsdf(b), wo,
                            {float(x), float(r * std::cos(phi)), float(r * std::sin(phi))});
                        light += value.f.g;
                        density += value.pdf;
                    }
                    const double area = 2 * kTurn / (kSines * kAngles);
                    EXPECT_NEAR(light * area, 1, 2e-3) << beta_m << " " << beta_n << " " << sin_o;
                    EXPECT_NEAR(density * area, 1, 2e-3);
                    EXPECT_NEAR(albedo(b, wo).g, 1, 1e-5f);
                }
}

TEST(BsdfHair, NoSampleHasMoreThanItsLight) {
    Rng rng(6);
    for (int i = 0; i < 20000; ++i) {
        HairShape shape = some_shape(rng);
        if (i % 4 == 0) shape.beta_m = shape.beta_n = 0;
        const Rgb absorption{rng.next_float(), 30 * rng.next_float(), 1000 * rng.next_float()};
        const HairBsdf b = with_offset(make_hair(shape, absorption), 2 * rng.next_float() - 1);
        const auto s = sample(b, square_to_sphere(rng.next_2d()), rng.next_float(), rng.next_2d());
        ASSERT_TRUE(s);
        EXPECT_LE(max_component(s->weight), 1 + 1e-5f);
    }
}

TEST(BsdfHair, AbsorptionOfColoursAndPigments) {
    // (ln(1/2) / 5.888415)^2, and the square of the same logarithm over 5.969.
    EXPECT_NEAR(absorption_of_reflectance(Rgb(0.5f), 0.3f).g, 0.0138567f, 1e-6f);
    EXPECT_NEAR(absorption_of_reflectance(Rgb(0.5f), 0).g, 0.0134848f, 1e-6f);
    EXPECT_EQ(absorption_of_reflectance(Rgb(1), 0.3f), Rgb(0));
    EXPECT_TRUE(is_finite(absorption_of_reflectance(Rgb(0), 0.3f)));
    const Rgb a = absorption_of_pigments(2, 3);
    EXPECT_NEAR(a.r, 1.399f, 1e-6f);
    EXPECT_NEAR(a.g, 2.594f, 1e-6f);
    EXPECT_NEAR(a.b, 5.89f, 1e-6f);
}

}  // namespace
}  // namespace covtrace
