#include "bsdf/fresnel.h"

#include <gtest/gtest.h>

#include <complex>

namespace covtrace {
namespace {

/// The textbook amplitudes in complex numbers, double precision.
double fresnel_reference(double cos_i, std::complex<double> eta) {
    const std::complex<double> sin2_t = (1 - cos_i * cos_i) / (eta * eta);
    const std::complex<double> cos_t = std::sqrt(1.0 - sin2_t);
    const std::complex<double> p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    const std::complex<double> s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return (std::norm(p) + std::norm(s)) / 2;
}

TEST(Fresnel, DielectricAgreesWithComplexAmplitudes) {
    for (float eta : {0.4f, 1 / 1.5f, 1.0f, 1.33f, 1.5f, 2.4f})
        for (int i = 1; i <= 100; ++i) {
            const float cos_i = static_cast<float>(i) / 100;
            EXPECT_NEAR(fresnel_dielectric(cos_i, eta).reflectance, fresnel_reference(cos_i, eta),
                        2e-6)
                << "eta " << eta << " cos " << cos_i;
        }
}

TEST(Fresnel, DielectricKnownValues) {
    EXPECT_NEAR(fresnel_dielectric(1, 1.5f).reflectance, 0.04f, 1e-7f);
    EXPECT_EQ(fresnel_dielectric(0, 1.5f).reflectance, 1);
    // Total reflection from the inside begins at sin = 1 / eta.
    const float critical = std::sqrt(1 - 1 / (1.5f * 1.5f));
    EXPECT_EQ(fresnel_dielectric(critical - 1e-3f, 1 / 1.5f).reflectance, 1);
    EXPECT_LT(fresnel_dielectric(critical + 1e-3f, 1 / 1.5f).reflectance, 0.95f);
    // Refraction obeys Snell's law.
    const float cos_t = fresnel_dielectric(0.6f, 1.5f).cos_t;
    EXPECT_NEAR(std::sqrt(1 - cos_t * cos_t) * 1.5f, 0.8f, 1e-6f);
}

TEST(Fresnel, DielectricIsTheSameFromBothSides) {
    for (float cos_i : {0.1f, 0.4f, 0.7f, 0.95f}) {
        const DielectricFresnel f = fresnel_dielectric(cos_i, 1.5f);
        EXPECT_NEAR(f.reflectance, fresnel_dielectric(f.cos_t, 1 / 1.5f).reflectance, 1e-5f);
    }
}

TEST(Fresnel, ConductorAgreesWithComplexAmplitudes) {
    for (float eta : {0.05f, 0.2f, 1.0f, 1.5f, 4.0f})
        for (float k : {0.0f, 0.1f, 1.0f, 3.9f, 10.0f})
            for (int i = 1; i <= 50; ++i) {
                const float cos_i = static_cast<float>(i) / 50;
                EXPECT_NEAR(fresnel_conductor(cos_i, eta, k), fresnel_reference(cos_i, {eta, k}),
                            2e-5)
                    << "eta " << eta << " k " << k << " cos " << cos_i;
            }
}

TEST(Fresnel, ConductorNeverLeavesTheUnitInterval) {
    for (float eta : {0.0f, 1e-4f, 1.0f, 100.0f})
        for (float k : {0.0f, 1e-4f, 1.0f, 200.0f})
            for (float cos_i : {0.0f, 1e-20f, 1e-4f, 0.5f, 1.0f, 1.000001f}) {
                const float f = fresnel_conductor(cos_i, eta, k);
                EXPECT_TRUE(f >= -1e-6f && f <= 1 + 1e-6f)
                    << eta << " " << k << " " << cos_i << " " << f;
            }
}

}  // namespace
}  // namespace covtrace
