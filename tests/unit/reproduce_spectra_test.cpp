// Spectra of grids, combs of samples and their replicas.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reproduce/comb.h"
#include "reproduce/grid_spectrum.h"
#include "reproduce/space_time.h"

namespace covtrace::reproduce {
namespace {

/// A Gaussian in the middle of a grid whose amplitudes have the covariance `s`.
Grid pulse(int side, const covariance::Sym2<double>& s) {
    Grid grid(side, side);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const double dx = x - side / 2, dy = y - side / 2;
            const double form = s.xx * dx * dx + 2 * s.xy * dx * dy + s.yy * dy * dy;
            grid.at(x, y) = std::exp(-2 * std::numbers::pi * std::numbers::pi * form);
        }
    return grid;
}

TEST(GridSpectrum, FindsAWaveAtItsFrequency) {
    Grid grid(20, 12);
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x)
            grid.at(x, y) = std::cos(2 * std::numbers::pi * (3.0 * x / 20 - 2.0 * y / 12));
    const GridSpectrum spectrum(grid);
    for (int j = 0; j < grid.height; ++j)
        for (int i = 0; i < grid.width; ++i) {
            const bool there = (i == 13 && j == 4) || (i == 7 && j == 8);
            EXPECT_NEAR(std::abs(spectrum.at(i, j)), there ? 120 : 0, 1e-9) << i << " " << j;
        }
    EXPECT_DOUBLE_EQ(spectrum.frequency_x(13), 3.0 / 20);
    EXPECT_DOUBLE_EQ(spectrum.frequency_y(4), -2.0 / 12);
}

TEST(GridSpectrum, OfAPaddedGridHasTheSameValuesBetween) {
    Grid grid(9, 6);
    for (size_t i = 0; i < grid.values.size(); ++i) grid.values[i] = std::sin(double(i * i));
    const GridSpectrum coarse(grid), fine(padded(grid, 27, 18));
    for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 9; ++i) {
            const int fi = 27 / 2 + 3 * (i - 9 / 2), fj = 18 / 2 + 3 * (j - 6 / 2);
            EXPECT_NEAR(std::abs(coarse.at(i, j)), std::abs(fine.at(fi, fj)), 1e-9);
        }
}

TEST(Comb, KeepsTheMeanOfASmoothSignal) {
    const covariance::Sym2<double> s{0.0016, 0.0004, 0.0009};
    const Grid signal = pulse(64, s), samples = sampled(signal, comb_for(s, 4));
    double all = 0, of_samples = 0;
    for (const double v : signal.values) all += v;
    for (const double v : samples.values) of_samples += v;
    EXPECT_NEAR(of_samples / all, 1, 0.01);
}

TEST(Comb, LeavesBehindTheFilterWhatIsPredictedOfAGaussian) {
    // Correlated axes, and rates from much overlap of the replicas to nearly none.
    const covariance::Sym2<double> s{0.0036, 0.0007, 0.0036};
    const Grid signal = pulse(48, s);
    double last = 1e9;
    for (const double rate : {2.0, 3.0, 4.0}) {
        const Comb comb = comb_for(s, rate);
        const double measured = measured_alias(signal, comb, s);
        EXPECT_NEAR(measured / predicted_alias(comb, s), 1, 0.03) << rate;
        EXPECT_LT(measured, last);
        last = measured;
    }
    EXPECT_LT(last, 0.01);
}

TEST(SpaceTime, FindsTheWayAndTheBandwidthOfAMovingPulse) {
    // A Gaussian pulse of deviation 5 pixels that moves 9 pixels in a shutter interval.
    constexpr double kDeviation = 5, kWay = 9;
    const std::array<double, 2> window{60, 0.18 * kSlots * kIntervals};
    Grid slice(256, kSlots * kIntervals);
    for (int slot = 0; slot < slice.height; ++slot)
        for (int x = 0; x < slice.width; ++x) {
            const double t = (slot + 0.5) / kSlots - 0.5 * kIntervals;
            const double d = (x + 0.5 - 128 - kWay * t) / kDeviation;
            slice.at(x, slot) = std::exp(-0.5 * d * d);
        }
    const SpaceTimeCovariance m = measured_covariance({slice}, window);
    const double bandwidth = 1 / (2 * std::numbers::pi * kDeviation);
    EXPECT_NEAR(m.way(), kWay, 0.1);
    EXPECT_NEAR(std::sqrt(m.xx), bandwidth, 0.02 * bandwidth);
    EXPECT_NEAR(std::sqrt(m.tt), kWay * bandwidth, 0.02 * kWay * bandwidth);
    // The shutter adds way²/12 to the pulse's variance.
    const double wider = std::sqrt(kDeviation * kDeviation + kWay * kWay / 12);
    EXPECT_NEAR(std::sqrt(m.behind), bandwidth * kDeviation / wider, 0.03 * bandwidth);
    EXPECT_LT(m.behind, 0.9 * m.xx);
}

TEST(SpaceTime, ShutterTakesTheMiddleInterval) {
    Grid slice(2, kSlots * kIntervals);
    for (int slot = 0; slot < slice.height; ++slot) slice.at(1, slot) = slot;
    EXPECT_DOUBLE_EQ(integrated(slice).at(1, 0), 1.5 * kSlots - 0.5);
    EXPECT_EQ(while_open(slice).at(1, kSlots - 1), 0);
    EXPECT_EQ(while_open(slice).at(1, kSlots), kSlots);
    EXPECT_EQ(moment(slice, 7).at(1, 0), 7);
    double sum = 0;
    for (const double v : windowed(without_mean(slice, {1, 9}), {1, 9}).values) sum += v;
    EXPECT_NEAR(sum, 0, 1e-9);
}

TEST(Comb, FilterKeepsEvenLight) {
    const covariance::Sym2<double> s{0.004, 0, 0.004};
    Grid even(41, 41);
    for (double& v : even.values) v = 3;
    EXPECT_NEAR(filtered(even, s).at(20, 20), 3, 1e-6);
}

}  // namespace
}  // namespace covtrace::reproduce
