/// Light that may be sampled in a way of its own or left to paths: the image is the same.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

#include "path_moments.h"

namespace covtrace::test {

struct SampledLightScene {
    const char* name;
    const char* world;
    int max_depth = 6;
    /// Bound on the variance of a path over that without the sampling; the estimates have heavy
    /// tails.
    double most_noise = 1.3;
};
inline void PrintTo(const SampledLightScene& s, std::ostream* out) {
    *out << s.name;
}

/// Expects the means with and without the sampling to be within 4.5 standard errors (false alarm
/// 7e-6), and the variance with it to be at most `most_noise` times that without. `samples`: what
/// turns it on; it stays on where `is_possible`.
inline void expect_same_light(RenderScene& scene, bool RenderScene::*samples, double most_noise,
                              bool is_possible = true) {
    scene.*samples = false;
    const Moments by_paths = trace_many(scene, 5);
    scene.*samples = is_possible;
    const Moments sampled = trace_many(scene, 6);
    EXPECT_NEAR(by_paths.mean(), sampled.mean(),
                4.5 * std::hypot(by_paths.error(), sampled.error()) + 1e-6 * by_paths.mean());
    EXPECT_LE(sampled.variance(), most_noise * by_paths.variance());
}

}  // namespace covtrace::test
