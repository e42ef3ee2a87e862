// Shares beyond a limit from noisy measurements, where the truth is known.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/rng.h"
#include "laboratory/deconvolution.h"

namespace covtrace {
namespace {

struct Sample {
    std::vector<float> values, deviations;
    double counted = 0;  ///< share of the measurements beyond the limit
};

float normal(Rng& rng) {
    return std::sqrt(-2 * std::log(1 - rng.next_float())) * std::cos(6.2831853f * rng.next_float());
}

/// Measures values of which the share `beyond` is 3 in size, the others 0.3; noise of 0.5 to 1.5
/// deviations.
Sample measured(size_t count, double beyond, uint64_t seed) {
    Rng rng(seed);
    Sample s;
    for (size_t i = 0; i < count; ++i) {
        const float sign = rng.next_float() < 0.5f ? -1.0f : 1.0f;
        const float truth = sign * (rng.next_float() < beyond ? 3.0f : 0.3f);
        const float deviation = 0.5f + rng.next_float();
        s.deviations.push_back(deviation);
        s.values.push_back(truth + deviation * normal(rng));
        if (std::abs(s.values.back()) > 1) s.counted += 1.0 / double(count);
    }
    return s;
}

TEST(Deconvolution, ExactMeasurementsAreCounted) {
    const std::vector<float> values{0, 0.5f, -0.9f, 1.2f, -8, 300, 0.1f, 0.2f}, exact(8, 0.0f);
    EXPECT_NEAR(share_beyond(values, exact), 3.0 / 8, 1e-3);
    EXPECT_EQ(share_beyond({}, {}), 0);
}

TEST(Deconvolution, NoiseIsNotCounted) {
    for (const double beyond : {0.0, 0.05, 0.3}) {
        double mean = 0, counted = 0;
        constexpr int kRuns = 12;
        for (uint64_t run = 0; run < kRuns; ++run) {
            const Sample s = measured(240, beyond, 10 + run);
            mean += share_beyond(s.values, s.deviations) / kRuns;
            counted += s.counted / kRuns;
        }
        EXPECT_NEAR(mean, beyond, 0.06) << beyond;
        EXPECT_GT(counted, beyond + 0.15) << beyond;
    }
}

}  // namespace
}  // namespace covtrace
