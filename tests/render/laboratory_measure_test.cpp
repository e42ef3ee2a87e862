// The measurement itself, on fields whose bandwidth is known.
#include "tests/render/laboratory_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

using Matrix = covariance::SymmetricMatrix5<double>;

double form(const Matrix& s, const SensorOffset& p) {
    double sum = 0;
    for (size_t i = 0; i < 5; ++i)
        for (size_t j = 0; j < 5; ++j) sum += p[i] * s(i, j) * p[j];
    return sum;
}

TEST(LaboratoryMeasure, ACorrelatedGaussianIsExact) {
    Matrix sigma = Matrix::diagonal(0.05, 0.002, 2, 0.8, 5);
    sigma(0, 2) = 0.2, sigma(1, 3) = -0.03, sigma(0, 4) = 0.3, sigma(2, 4) = 1;
    const LocalField field = [&](const SensorOffset& p, uint32_t) {
        return std::exp(-2 * kPiD * kPiD * form(sigma, p));
    };
    const MeasuredSpectrum m = measure(field, {.samples = 1u << 15});
    for (size_t i = 0; i < 5; ++i)
        for (size_t j = 0; j < 5; ++j)
            EXPECT_NEAR(m.sigma(i, j), sigma(i, j), 0.01 * std::sqrt(sigma(i, i) * sigma(j, j)))
                << i << ", " << j;
}

TEST(LaboratoryMeasure, AConstantAndARampHaveNoBandwidth) {
    for (const double slope : {0.0, 0.01}) {
        const LocalField field = [&](const SensorOffset& p, uint32_t) {
            return 1 + slope * (p[0] + p[1]);
        };
        const MeasureOptions options{.samples = 1u << 14};
        const MeasuredSpectrum m = measure(field, options);
        for (size_t i = 0; i < 5; ++i) {
            EXPECT_FALSE(is_resolved(m.sigma(i, i), i, options)) << i;
            EXPECT_GT(m.window[i], 0.8 * (i < 2 ? 15 : i < 4 ? 0.25 : 0.125)) << i;
        }
    }
}

/// An exponential of relative slope k has the relative second derivative k^2 everywhere.
TEST(LaboratoryMeasure, AnExponentialFlankHasTheBandwidthOfItsSecondDerivative) {
    const double k = 0.3;
    const LocalField field = [&](const SensorOffset& p, uint32_t) { return std::exp(k * p[0]); };
    const MeasuredSpectrum m = measure(field, {.samples = 1u << 15});
    EXPECT_NEAR(std::sqrt(m.sigma(0, 0)) * 2 * kPiD / k, 1, 0.15);
}

/// The window settles where the edge begins to show in it: the Gaussian of the measured bandwidth
/// has about the distance of the edge as its deviation, twice that of the rule for edges.
TEST(LaboratoryMeasure, ASharpEdgeReadsByItsDistance) {
    for (const double distance : {1.0, 3.0}) {
        const LocalField field = [&](const SensorOffset& p, uint32_t) {
            return p[0] < distance ? 1.0 : 0.0;
        };
        const MeasuredSpectrum m = measure(field, {.samples = 1u << 16});
        const double deviation = 1 / (2 * kPiD * std::sqrt(m.sigma(0, 0)));
        EXPECT_GT(deviation, 0.8 * distance);
        EXPECT_LT(deviation, 1.3 * distance);
    }
}

/// Estimates have a relative standard deviation of 2: the mean survives, the stated error covers
/// it. False-alarm rate of the last check 6e-5 per axis (four deviations), two axes.
TEST(LaboratoryMeasure, NoiseIsNotTakenForBandwidth) {
    const Matrix sigma = Matrix::diagonal(0.01, 0.002, 0, 0, 0);
    const LocalField field = [&](const SensorOffset& p, uint32_t index) {
        Sampler noise(5, 0, 0, index);
        const double bright = noise.next_1d() < 0.2f ? 5 : 0;
        return bright * std::exp(-2 * kPiD * kPiD * form(sigma, p));
    };
    const MeasuredSpectrum m = measure(field, {.samples = 1u << 17});
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(std::sqrt(m.sigma(i, i) / sigma(i, i)), 1, 0.1) << i;
        EXPECT_NEAR(std::sqrt(m.sigma(i, i)), std::sqrt(sigma(i, i)), 4 * m.bandwidth_error[i]);
    }
}

TEST(LaboratoryMeasure, TheSpreadOfABlurredEdgeIsThatOfItsBlur) {
    const double blur = 1.7, centre = 0.6;
    const LocalField field = [&](const SensorOffset& p, uint32_t) {
        const double s = 0.8 * p[0] + 0.6 * p[1];
        return 0.3 + 0.5 * std::erfc(-(s - centre) / (std::sqrt(2.0) * blur));
    };
    const EdgeSpread e = edge_spread(field, nullptr, {0.8f, 0.6f}, 10, 20000, 0);
    EXPECT_NEAR(e.deviation, blur, 0.01);
    EXPECT_NEAR(e.centre, centre, 0.01);
    EXPECT_NEAR(e.low, 0.3, 1e-3);
    EXPECT_NEAR(e.high, 1.3, 1e-3);
}

}  // namespace
}  // namespace covtrace
