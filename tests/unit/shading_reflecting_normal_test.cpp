// Normals that are turned to let mirrored light leave the surface: laws for random directions.
#include "shading/reflecting_normal.h"

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/warp.h"

namespace covtrace {
namespace {

/// Cosine of the mirrored direction to the geometric normal on the side of w.
float height(Vec3 n, Vec3 ng, Vec3 w) {
    const Vec3 mirrored = n * (2 * dot(n, w)) - w;
    return dot(mirrored, ng) * (dot(w, ng) < 0 ? -1.0f : 1.0f);
}

/// The angle between two unit vectors, also where it is small.
float angle(Vec3 a, Vec3 b) {
    return std::atan2(length(cross(a, b)), dot(a, b));
}

TEST(ReflectingNormal, IsTurnedInItsPlaneUntilMirroredLightLeavesAndNoFarther) {
    Rng rng(5);
    int turned = 0;
    for (int i = 0; i < 20'000; ++i) {
        const Vec3 ng = square_to_sphere({rng.next_float(), rng.next_float()});
        Vec3 n = square_to_sphere({rng.next_float(), rng.next_float()});
        if (dot(n, ng) < 0) n = -n;
        const Vec3 w = square_to_sphere({rng.next_float(), rng.next_float()});
        const float least = std::min(0.01f, 0.9f * std::abs(dot(w, ng)));
        const Vec3 result = reflecting_normal(n, ng, w);
        if (height(n, ng, w) >= least) {
            EXPECT_EQ(result, n);
            continue;
        }
        ++turned;
        EXPECT_NEAR(length(result), 1, 1e-5f);
        EXPECT_NEAR(height(result, ng, w), least, 1e-4f);
        // It lies between both, and looks towards w
        EXPECT_NEAR(angle(n, result) + angle(result, ng), angle(n, ng), 1e-3f);
        EXPECT_GT(dot(result, w) * dot(ng, w), 0);
        // Everything from there to n mirrors lower
        for (const float t : {0.1f, 0.5f, 0.9f})
            EXPECT_LT(height(normalize(result * (1 - t) + n * t), ng, w), least + 1e-4f);
    }
    EXPECT_GT(turned, 5000);
}

TEST(ReflectingNormal, IsTheSameForBothSides) {
    Rng rng(6);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 ng{0, 0, 1};
        Vec3 n = square_to_sphere({rng.next_float(), rng.next_float()});
        n.z = std::abs(n.z);
        const Vec3 w = square_to_sphere({rng.next_float(), rng.next_float()});
        EXPECT_EQ(reflecting_normal(n, ng, -w), -reflecting_normal(-n, -ng, -w));
    }
}

TEST(ReflectingNormal, StandsWhereTheSurfacesOwnNormalDoesSeenAlongTheSurface) {
    const Vec3 ng{0, 0, 1}, n = normalize(Vec3{0.3f, 0, 1});
    const Vec3 result = reflecting_normal(n, ng, {-1, 0, 0});
    EXPECT_NEAR(distance(result, ng), 0, 1e-3f);
    EXPECT_EQ(reflecting_normal(ng, ng, {-1, 0, 0}), ng);
}

}  // namespace
}  // namespace covtrace
