// Covariances in 40 bytes: the precision that is kept, and that the integral over lens and shutter
// survives.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "prediction/packed_covariance.h"

namespace covtrace {
namespace {

using Matrix = covariance::SymmetricMatrix5<double>;

/// A covariance of `rank` random directions, with axes of very different units.
Matrix random_covariance(std::mt19937& random, int rank) {
    std::normal_distribution<double> normal;
    std::array<double, 5> unit{};
    for (double& u : unit) u = std::exp(3 * normal(random));
    Matrix s;
    for (int r = 0; r < rank; ++r) {
        std::array<double, 5> d{};
        for (size_t i = 0; i < 5; ++i) d[i] = unit[i] * normal(random);
        for (size_t i = 0; i < 5; ++i)
            for (size_t j = i; j < 5; ++j) s(i, j) += d[i] * d[j];
    }
    return s;
}

TEST(PackedCovariance, KeepsEveryEntry) {
    std::mt19937 random(1);
    for (int k = 0; k < 5000; ++k) {
        const Matrix s = random_covariance(random, 1 + k % 7);
        const PackedCovariance packed(s, 2.5f);
        EXPECT_EQ(packed.weight, 2.5f);
        const Matrix back = packed.covariance();
        for (size_t i = 0; i < 5; ++i)
            for (size_t j = i; j < 5; ++j)
                EXPECT_NEAR(back(i, j), s(i, j), std::sqrt(s(i, i) * s(j, j)) / 1024);
    }
}

/// Strong correlations of position with lens and shutter, as out of focus and in motion: the result
/// of the integral is up to 10^8 times smaller than the terms of which it is the difference.
TEST(PackedCovariance, KeepsWhatTheIntegralOverLensAndShutterLeaves) {
    std::mt19937 random(2);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 5000; ++k) {
        Matrix s;
        const double rest = std::pow(10.0, -4 * double(k % 100) / 100);
        std::array<std::array<double, 3>, 2> slope{};
        for (auto& row : slope)
            for (double& v : row) v = 30 * normal(random);
        const std::array<double, 3> spread{100, 100, 100};
        for (size_t i = 0; i < 3; ++i) s(2 + i, 2 + i) = spread[i];
        for (size_t i = 0; i < 2; ++i) {
            for (size_t j = 0; j < 3; ++j) s(i, 2 + j) = slope[i][j] * spread[j];
            for (size_t j = i; j < 2; ++j)
                for (size_t n = 0; n < 3; ++n) s(i, j) += slope[i][n] * slope[j][n] * spread[n];
            s(i, i) += rest;
        }
        const auto expected = covariance::preintegrate(s);
        const auto kept = covariance::preintegrate(PackedCovariance(s, 1).covariance());
        const double scale = std::max(expected.xx, expected.yy);
        EXPECT_NEAR(kept.xx, expected.xx, 0.004 * scale);
        EXPECT_NEAR(kept.xy, expected.xy, 0.004 * scale);
        EXPECT_NEAR(kept.yy, expected.yy, 0.004 * scale);
    }
}

/// Paths have nearly the same slopes, as before a plane out of focus: the integral leaves of their
/// mean the part by which the slopes differ. With slopes that are wrong by 2^-11 it came out up to
/// twice as large.
TEST(PackedCovariance, MeanKeepsWhatSlopesDifferBy) {
    std::mt19937 random(4);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 5000; ++k) {
        covariance::Accumulator<double> exact, kept;
        const double slope = 3 * normal(random), other = 3 * normal(random);
        for (int path = 0; path < 4; ++path) {
            // Position follows the lens by a slope that varies by a thousandth.
            const double spread = 1e4 * std::exp(normal(random));
            const double kx = slope * (1 + 1e-3 * normal(random));
            const double ky = other * (1 + 1e-3 * normal(random));
            Matrix s;
            s(2, 2) = s(3, 3) = spread;
            s(0, 2) = kx * spread;
            s(1, 3) = ky * spread;
            s(0, 0) = kx * kx * spread * (1 + 1e-9);
            s(1, 1) = ky * ky * spread * (1 + 1e-9);
            exact.add(s, 1);
            kept.add(PackedCovariance(s, 1).covariance(), 1);
        }
        const auto expected = covariance::preintegrate(exact.mean());
        const auto found = covariance::preintegrate(PackedCovariance(kept.mean(), 1).covariance());
        EXPECT_NEAR(found.xx / expected.xx, 1, 0.05);
        EXPECT_NEAR(found.yy / expected.yy, 1, 0.05);
    }
}

TEST(PackedCovariance, PackingAgainChangesNothing) {
    std::mt19937 random(3);
    for (int k = 0; k < 2000; ++k) {
        const PackedCovariance once(random_covariance(random, 5), 1);
        const PackedCovariance twice(once.covariance(), 1);
        EXPECT_EQ(twice.covariance().values, once.covariance().values);
    }
}

TEST(PackedCovariance, ZeroAndWhatIsNoCovariance) {
    EXPECT_EQ(PackedCovariance().covariance().values, Matrix().values);
    EXPECT_EQ(PackedCovariance(Matrix(), 0).covariance().values, Matrix().values);
    for (double v : {-1.0, 1e300, 1e-300, double(INFINITY), double(NAN)}) {
        const Matrix back = PackedCovariance(Matrix::diagonal(v, 1, v, 2, v), 1).covariance();
        for (double entry : back.values) EXPECT_TRUE(std::isfinite(entry)) << v;
        EXPECT_NEAR(back(1, 1), 1, 1e-3);
    }
}

}  // namespace
}  // namespace covtrace
