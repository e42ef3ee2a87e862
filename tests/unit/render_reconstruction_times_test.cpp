// The denoiser's quality that a budget of time allows.
#include <gtest/gtest.h>

#include <limits>

#include "render/methods/reconstruction_times.h"

namespace covtrace {
namespace {

constexpr auto kHigh = DenoiserQuality::high, kFast = DenoiserQuality::fast;
constexpr double kEndless = std::numeric_limits<double>::infinity();

const ReconstructionTimes kTimes{5, {{kHigh, 20}, {kFast, 6}}};

std::optional<DenoiserQuality> affordable(double left, double sampling = kEndless,
                                          std::optional<DenoiserQuality> asked = {}) {
    return affordable_quality(kTimes, asked, left, sampling);
}

TEST(AffordableQuality, HighTakesThreeTenthsAtMost) {
    EXPECT_EQ(affordable(67), kHigh);
    EXPECT_EQ(affordable(66), kFast);
    EXPECT_EQ(affordable(7), kFast);
}

TEST(AffordableQuality, HighMayTakeWhatTheSamplesLeave) {
    EXPECT_EQ(affordable(25, 4), kHigh);
    EXPECT_EQ(affordable(25, 6), kFast);
}

TEST(AffordableQuality, NoneIsThereWhereItTakesTooLong) {
    EXPECT_EQ(affordable(5.5), std::nullopt);
    EXPECT_EQ(affordable(-1), std::nullopt);
    EXPECT_EQ(affordable(19, kEndless, kHigh), std::nullopt);
}

TEST(AffordableQuality, AnImageThatIsLateAnywayIsTheQuickerOne) {
    const ReconstructionTimes slow_without{12, {{kHigh, 20}, {kFast, 6}}};
    EXPECT_EQ(affordable_quality(slow_without, {}, -1, kEndless), kFast);
}

TEST(AffordableQuality, WhatWasAskedForIsKept) {
    EXPECT_EQ(affordable(21, kEndless, kHigh), kHigh);
    EXPECT_EQ(affordable(1000, 1, kFast), kFast);
}

TEST(AffordableQuality, WithoutADenoiserThereIsNone) {
    EXPECT_EQ(affordable_quality({5, {}}, {}, 1000, 1), std::nullopt);
}

}  // namespace
}  // namespace covtrace
