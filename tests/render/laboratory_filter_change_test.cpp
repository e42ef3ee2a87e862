// Changes of pixels by filters, on fields where the change is known.
#include "laboratory/filter_change.h"

#include "tests/render/laboratory_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

constexpr uint32_t kSamples = 1u << 17;

covariance::Sym2<double> round_filter(double deviation) {
    return covariance::Sym2<double>::diagonal(deviation * deviation, deviation * deviation);
}

TEST(LaboratoryFilterChange, FilterOfASpectrumIsTheReconstructionsAtSixteenSamples) {
    const double variance = 0.01;
    covariance::SymmetricMatrix5<double> sigma;
    sigma(0, 0) = variance;
    const auto filter = filter_of(sigma);
    EXPECT_NEAR(filter.xx, 1 / (16 * kPiD * kPiD * variance), 1e-9);
    EXPECT_NEAR(filter.yy, 15 * 15, 1e-9);  // the widest
}

TEST(LaboratoryFilterChange, NothingChangesConstantsAndRamps) {
    for (const double slope : {0.0, 0.01}) {
        const LocalField field = [&](const SensorOffset& p, uint32_t) {
            return 1 + slope * (p[0] - 2 * p[1] + p[2] + p[4]);
        };
        const FilterChange c = filter_change(field, round_filter(3), kSamples, 1);
        EXPECT_LT(c.change, 0.003) << slope;
    }
}

/// A weave finer than the eye of the measured bandwidth has a contrast of 0.07 and a third of a
/// cycle per pixel. The bandwidth that is relative to the mean says that it may be smoothed over 15
/// pixels; the change tells that this would be seen.
TEST(LaboratoryFilterChange, TellsOfFaintDetailThatTheMeasuredBandwidthPassesOver) {
    constexpr double kContrast = 0.07, kFrequency = 1.0 / 3;
    const LocalField field = [](const SensorOffset& p, uint32_t) {
        return 1 + kContrast * std::cos(2 * kPiD * (kFrequency * p[0] + 0.1));
    };
    const MeasureOptions options{.samples = 1u << 15};
    const MeasuredSpectrum m = measure(field, options);
    EXPECT_LT(std::sqrt(m.sigma(0, 0)), 0.1 * kFrequency);
    const FilterChange wide = filter_change(field, filter_of(m.sigma), kSamples, 1);
    // The mean square of the cosine is that of all phases but for two of 25 pixels, as three pixels
    // are a period. A square pixel leaves sinc(1/3) of the wave.
    const double visible = kContrast * std::sin(kPiD * kFrequency) / (kPiD * kFrequency);
    EXPECT_NEAR(wide.change, visible / std::sqrt(2.0), 0.15 * visible);
    EXPECT_LT(wide.noise, 0.2 * wide.change);
    // A filter of half a pixel leaves this share of the wave.
    const FilterChange narrow = filter_change(field, round_filter(0.5), kSamples, 1);
    const double left = std::exp(-2 * std::pow(kPiD * kFrequency * 0.5, 2));
    EXPECT_NEAR(narrow.change, (1 - left) * visible / std::sqrt(2.0), 0.1 * visible);
}

TEST(LaboratoryFilterChange, FollowsTheFiltersDirection) {
    const LocalField field = [](const SensorOffset& p, uint32_t) {
        return 1 + 0.1 * std::cos(2 * kPiD * 0.2 * (p[0] + p[1]));
    };
    // Filters are long across the waves, and along them.
    const covariance::Sym2<double> across{4, 4, 4.01}, along{4, -4, 4.01};
    EXPECT_GT(filter_change(field, across, kSamples, 1).change, 0.04);
    EXPECT_LT(filter_change(field, along, kSamples, 1).change, 0.005);
}

}  // namespace
}  // namespace covtrace
