#include "texture/scalar_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace covtrace {
namespace {

ScalarField ramp(int width, int height) {
    ScalarField f(width, height, false, false);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) f.row(y)[x] = 2 * (float(x) + 0.5f) - 3 * (float(y) + 0.5f);
    return f;
}

/// Mean and variance along x of a field seen as a distribution.
struct Moments {
    double sum = 0, mean = 0, variance = 0;
};
Moments moments_along_x(const ScalarField& f) {
    Moments m;
    double first = 0, second = 0;
    for (int y = 0; y < f.height; ++y)
        for (int x = 0; x < f.width; ++x) {
            const double v = double(f.row(y)[x]);
            m.sum += v;
            first += v * x;
            second += v * x * x;
        }
    m.mean = first / m.sum;
    m.variance = second / m.sum - m.mean * m.mean;
    return m;
}

TEST(ScalarField, SmoothsByTheWindowsVariance) {
    ScalarField impulse(41, 41, false, false);
    impulse.row(20)[20] = 1;
    for (const float std : {1.0f, 2.0f}) {
        const GaussianWindow window(std);
        const Moments m = moments_along_x(smooth_inside(impulse, window));
        EXPECT_NEAR(m.sum, 1, 1e-5);
        EXPECT_NEAR(m.mean, 20 - window.radius, 1e-4);
        EXPECT_NEAR(m.variance, double(window.variance), 1e-3);
        EXPECT_NEAR(m.variance / double(std * std), 1, 0.05);
    }
}

TEST(ScalarField, RepeatsOrContinuesAtTheBorder) {
    for (const bool repeats : {true, false}) {
        ScalarField f(8, 1, repeats, false);
        f.row(0)[0] = 1;
        const ScalarField s = halved(f);
        EXPECT_EQ(s.row(0)[3] > 0.1f, repeats);
        EXPECT_EQ(s.row(0)[0] > 0.4f, !repeats);  // the border counts for all that is outside
    }
}

TEST(ScalarField, HalvesAndDoublesARampWithoutShiftingIt) {
    for (const int size : {16, 17}) {
        const ScalarField f = ramp(size, size + 3);
        const ScalarField half = halved(f);
        EXPECT_EQ(half.width, (size + 1) / 2);
        EXPECT_EQ(half.height, (size + 4) / 2);
        EXPECT_FLOAT_EQ(half.row(3)[2], 2 * 5 - 3 * 7);
        for (int y = 4; y < size - 4; ++y)
            for (int x = 4; x < size - 4; ++x) {
                const Between rows = between(y, f.height, half.height, false),
                              columns = between(x, f.width, half.width, false);
                const auto along = [&](int row) {
                    return std::lerp(half.row(row)[columns.first], half.row(row)[columns.second],
                                     columns.weight);
                };
                EXPECT_NEAR(std::lerp(along(rows.first), along(rows.second), rows.weight),
                            f.row(y)[x], 1e-4);
            }
    }
}

TEST(ScalarField, HalvesByAFilterOfThreeQuarters) {
    // The impulses are in both phases of the coarse grid: their mean variance in fine cells.
    double variance = 0;
    for (const int x : {20, 21}) {
        ScalarField impulse(42, 8, false, false);
        for (int y = 0; y < 8; ++y) impulse.row(y)[x] = 1;
        const Moments m = moments_along_x(halved(impulse));
        EXPECT_NEAR(m.sum, 0.5 * 4, 1e-5);
        // The spread is about the impulse itself; a coarse cell's centre is at 2 i + 0.5.
        const double offset = 2 * m.mean + 0.5 - x;
        variance += 0.5 * (4 * m.variance + offset * offset);
    }
    EXPECT_NEAR(variance, 0.75, 1e-4);
}

TEST(ScalarField, AveragesBoxesAndTheirRemainders) {
    const ScalarField f = ramp(7, 5);
    const ScalarField r = box_reduced([&f](size_t i) { return f.values[i]; }, f.width, f.height,
                                      f.repeat_x, f.repeat_y, 3);
    ASSERT_EQ(r.width, 3);
    ASSERT_EQ(r.height, 2);
    EXPECT_FLOAT_EQ(r.row(0)[0], 2 * 1.5f - 3 * 1.5f);
    EXPECT_FLOAT_EQ(r.row(1)[2], 2 * 6.5f - 3 * 4);
}

}  // namespace
}  // namespace covtrace
