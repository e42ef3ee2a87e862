#include "light/tree.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/rng.h"
#include "core/warp.h"
#include "light/weight.h"

namespace covtrace {
namespace {

LightBounds bulb(Vec3 at, float intensity = 1) {
    LightBounds b;
    b.box.extend(at);
    b.theta_o = kPi;
    b.intensity = intensity;
    return b;
}

LightBounds panel(Vec3 lo, Vec3 hi, Vec3 axis, bool two_sided = false) {
    LightBounds b;
    b.box.extend(lo);
    b.box.extend(hi);
    b.axis = axis;
    b.intensity = 1;
    b.two_sided = two_sided;
    return b;
}

double sum_of_probabilities(const LightTree& tree, size_t count, Vec3 p, Vec3 n) {
    double sum = 0;
    for (size_t i = 0; i < count; ++i) sum += double(tree.probability(p, n, int(i)));
    return sum;
}

TEST(LightTree, HoldsNothingWithoutLights) {
    for (const LightTree& tree :
         {LightTree(), LightTree(std::vector<LightBounds>{}), LightTree({bulb({}, 0)})}) {
        EXPECT_FALSE(tree.sample({1, 2, 3}, {}, 0.5f));
        EXPECT_EQ(tree.irradiance({1, 2, 3}, {}), 0);
    }
    EXPECT_EQ(LightTree({bulb({}, 0)}).probability({1, 2, 3}, {}, 0), 0);
}

TEST(LightTree, NeverChoosesDarkLights) {
    const LightTree tree(
        {bulb({0, 0, 0}, 0), bulb({1, 0, 0}), bulb({2, 0, 0}, 0), bulb({3, 0, 0})});
    for (int i = 0; i < 100; ++i) {
        const auto choice = tree.sample({1, 2, 3}, {}, float(i) / 100);
        ASSERT_TRUE(choice);
        EXPECT_EQ(choice->light % 2, 1);
    }
    EXPECT_EQ(tree.probability({1, 2, 3}, {}, 2), 0);
}

TEST(LightTree, LeavesOutAPanelSeenFromBehind) {
    const LightTree tree({panel({-1, -1, 2}, {1, 1, 2}, {0, 0, -1})});
    EXPECT_TRUE(tree.sample({0, 0, 0}, {}, 0.5f));
    EXPECT_EQ(tree.probability({0, 0, 0}, {}, 0), 1);
    EXPECT_FALSE(tree.sample({0, 0, 9}, {}, 0.5f));
    EXPECT_EQ(tree.probability({0, 0, 9}, {}, 0), 0);
    const LightTree both({panel({-1, -1, 2}, {1, 1, 2}, {0, 0, -1}, true)});
    EXPECT_TRUE(both.sample({0, 0, 9}, {}, 0.5f));
}

TEST(LightTree, PrefersNearBrightAndFacedLights) {
    const auto share = [](LightBounds a, LightBounds b, Vec3 p, Vec3 n) {
        return LightTree({a, b}).probability(p, n, 0);
    };
    EXPECT_NEAR(share(bulb({1, 0, 0}), bulb({-3, 0, 0}), {}, {}), 0.9, 1e-5);
    EXPECT_NEAR(share(bulb({1, 0, 0}, 3), bulb({-1, 0, 0}), {}, {}), 0.75, 1e-5);
    EXPECT_NEAR(share(bulb({0, 0, 1}), bulb({0.8f, 0, 0.6f}), {}, {0, 0, 1}), 1 / 1.6, 1e-5);
    // Light from behind the surface is not forgotten.
    EXPECT_NEAR(share(bulb({0, 0, 1}), bulb({0, 0, -1}), {}, {0, 0, 1}), 1 / 1.1, 1e-5);
}

TEST(LightTree, IrradianceIsOfWhatIsAboveTheHorizon) {
    // The cluster is a ball of lights, 0.1 wide each way, at distance 2: the cone's sine is sqrt(3)
    // 0.1 / 2.
    const auto at = [](float degrees) {
        const Vec3 c{2 * std::cos(degrees * kPi / 180), 0, 2 * std::sin(degrees * kPi / 180)};
        const Vec3 half{0.1f, 0.1f, 0.1f};
        LightBounds ball = bulb(c - half);
        ball.box.extend(c + half);
        return LightTree({ball}).irradiance({}, {0, 0, 1});
    };
    for (const float degrees : {10.0f, 30.0f, 90.0f})
        EXPECT_NEAR(at(degrees), std::sin(degrees * kPi / 180) / 4, 1e-3f) << degrees;
    EXPECT_EQ(at(-6), 0);
    // The horizon halves a disc: 2 / (3 pi) of its half-width is the mean height over all.
    const float sine = 0.1f * std::sqrt(3.0f) / 2;
    EXPECT_NEAR(at(0) * 4, 2 * sine / (3 * kPi), 0.25f * 2 * sine / (3 * kPi));
}

TEST(LightTree, CopesWithCoincidentLightsAndSkewedDistances) {
    std::vector<LightBounds> same(1000, bulb({1, 1, 1}));
    std::vector<LightBounds> skewed;
    for (int i = 0; i < 120; ++i) skewed.push_back(bulb({std::pow(0.6f, float(i)), 0, 0}));
    for (const auto& lights : {same, skewed}) {
        const LightTree tree(lights);
        EXPECT_NEAR(sum_of_probabilities(tree, lights.size(), {0.5f, 2, 1}, {0, 0, 1}), 1, 1e-4);
        EXPECT_NEAR(sum_of_probabilities(tree, lights.size(), {1, 1, 1}, {}), 1, 1e-4);
    }
}

RC_GTEST_PROP(LightTree, SamplesEachLightWithItsProbability, (uint32_t seed)) {
    Rng rng(seed);
    std::vector<LightBounds> lights;
    const int count = 1 + int(rng.next_float() * 40);
    for (int i = 0; i < count; ++i) {
        const Vec3 at = square_to_sphere(rng.next_2d()) * (5 * rng.next_float());
        const Vec3 axis = square_to_sphere(rng.next_2d());
        lights.push_back(
            i % 2 ? bulb(at, rng.next_float())
                  : panel(at, at + Vec3{rng.next_float(), 0.2f, 0.1f}, axis, i % 4 == 0));
    }
    const LightTree tree(lights);
    const Vec3 p = square_to_sphere(rng.next_2d()) * (8 * rng.next_float());
    const Vec3 n = seed % 2 ? square_to_sphere(rng.next_2d()) : Vec3{};
    constexpr int kSteps = 4000;
    std::vector<double> frequency(lights.size());
    for (int i = 0; i < kSteps; ++i)
        if (const auto choice = tree.sample(p, n, (float(i) + 0.5f) / kSteps)) {
            RC_ASSERT(std::abs(choice->probability / tree.probability(p, n, choice->light) - 1) <
                      1e-4f);
            frequency[size_t(choice->light)] += 1.0 / kSteps;
        }
    // Each light owns one interval of u, so that a regular grid misses it by two steps at most.
    for (size_t i = 0; i < lights.size(); ++i)
        RC_ASSERT(std::abs(frequency[i] - double(tree.probability(p, n, int(i)))) < 2.1 / kSteps);
}

// Factors on the children, whatever they are, and the even half of `explore`: probabilities stay
// those of the choices, and no light that may shine is ruled out.
RC_GTEST_PROP(LightTree, SamplesByFactorsAndExploresWithTheirProbabilities, (uint32_t seed)) {
    Rng rng(seed);
    std::vector<LightBounds> lights;
    const int count = 2 + int(rng.next_float() * 600);
    for (int i = 0; i < count; ++i)
        lights.push_back(bulb(square_to_sphere(rng.next_2d()) * (5 * rng.next_float()),
                              0.1f + rng.next_float()));
    const LightTree tree(lights);
    std::vector<float> factors(tree.factor_count());
    for (float& f : factors) f = 0.01f + sqr(rng.next_float());
    const Vec3 p = square_to_sphere(rng.next_2d()) * 8.0f, n = square_to_sphere(rng.next_2d());
    constexpr int kSteps = 20000;
    std::vector<double> frequency(lights.size());
    std::vector<LightTree::Step> way;
    double explored = 0;
    for (int i = 0; i < kSteps; ++i) {
        const float u = (float(i) + 0.5f) / kSteps;
        const auto choice = tree.sample(p, n, u, factors);
        RC_ASSERT(choice.has_value());
        const float probability = tree.probability(p, n, choice->light, factors);
        RC_ASSERT(std::abs(choice->probability / probability - 1) < 1e-3f);
        frequency[size_t(choice->light)] += 1.0 / kSteps;
        // The steps tell both probabilities of the light that was explored
        const auto trial = tree.explore(p, n, u, way);
        RC_ASSERT(trial.has_value());
        float tried = 1, by_importance = 1;
        for (const LightTree::Step& step : way) {
            tried *= step.tried;
            by_importance *= step.probability;
        }
        RC_ASSERT(std::abs(trial->probability / tried - 1) < 1e-3f);
        RC_ASSERT(std::abs(by_importance / tree.probability(p, n, trial->light) - 1) < 1e-3f);
        RC_ASSERT(tried >= by_importance * std::pow(0.5f, float(way.size())));
        explored += double(by_importance / tried) / kSteps;
    }
    for (size_t i = 0; i < lights.size(); ++i) {
        const double p_i = double(tree.probability(p, n, int(i), factors));
        RC_ASSERT(p_i > 0);
        RC_ASSERT(std::abs(frequency[i] - p_i) < 2.1 / kSteps + 1e-4 * p_i);
    }
    RC_ASSERT(std::abs(explored - 1) < 0.02);
}

RC_GTEST_PROP(LightTree, NeverRulesOutALightThatShinesOnThePoint, (uint32_t seed)) {
    Rng rng(seed);
    std::vector<LightBounds> lights;
    std::vector<std::array<Vec3, 3>> triangles;
    for (int i = 0; i < 20; ++i) {
        const auto corner = [&] {
            return square_to_sphere(rng.next_2d()) * (3 * rng.next_float());
        };
        const Vec3 a = corner(), b = a + corner() * 0.3f, c = a + corner() * 0.3f;
        LightBounds bounds = panel(a, b, normalize(cross(b - a, c - a)));
        bounds.box.extend(c);
        lights.push_back(bounds);
        triangles.push_back({a, b, c});
    }
    const LightTree tree(lights);
    for (int k = 0; k < 50; ++k) {
        const Vec3 p = square_to_sphere(rng.next_2d()) * (4 * rng.next_float());
        const Vec3 n = k % 2 ? square_to_sphere(rng.next_2d()) : Vec3{};
        for (size_t i = 0; i < triangles.size(); ++i) {
            const Vec3 to_point = normalize(p - triangles[i][0]);
            if (dot(lights[i].axis, to_point) > 1e-3f)
                RC_ASSERT(tree.probability(p, n, int(i)) > 0);
        }
    }
}

RC_GTEST_PROP(LightBounds, MergedConesHoldBoth, (uint32_t seed)) {
    Rng rng(seed);
    LightBounds a = bulb({0, 0, 0}), b = bulb({1, 1, 1});
    for (LightBounds* l : {&a, &b}) {
        l->axis = square_to_sphere(rng.next_2d());
        l->theta_o = rng.next_float() * 2;
    }
    if (seed % 5 == 0) b.axis = -a.axis;
    const LightBounds m = merge(a, b);
    RC_ASSERT(m.intensity == 2.0f);
    for (const LightBounds* l : {&a, &b})
        for (int i = 0; i < 50; ++i) {
            // The direction is on the rim of the smaller cone.
            const Vec3 side = normalize(cross(l->axis, square_to_sphere(rng.next_2d())));
            const Vec3 w = l->axis * std::cos(l->theta_o) + side * std::sin(l->theta_o);
            const float angle = std::atan2(length(cross(m.axis, w)), dot(m.axis, w));
            RC_ASSERT(angle <= m.theta_o + 1e-3f);
        }
}

}  // namespace
}  // namespace covtrace
