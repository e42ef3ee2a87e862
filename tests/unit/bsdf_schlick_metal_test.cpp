#include "bsdf/schlick_metal.h"

#include <gtest/gtest.h>

namespace covtrace {
namespace {

TEST(SchlickMetal, HasItsColoursAtTheAnglesThatTheyAreOf) {
    const Rgb normal(0.9f, 0.5f, 0), edge(0.6f, 1, 0.3f);
    const SchlickMetal<Rgb> metal = metal_of_edge(normal, edge);
    EXPECT_EQ(schlick_reflectance(1, metal), normal);
    EXPECT_EQ(schlick_reflectance(0, metal), Rgb(1));
    const Rgb found = schlick_reflectance(1 / 7.0f, metal);
    for (int c = 0; c < 3; ++c) {
        const float plain = normal[c] + (1 - normal[c]) * std::pow(6 / 7.0f, 5.0f);
        EXPECT_NEAR(found[c], plain * edge[c], 1e-6f) << c;
    }
}

TEST(SchlickMetal, NeverLeavesTheUnitInterval) {
    for (const float normal : {0.0f, 0.1f, 0.5f, 1.0f})
        for (const float edge : {0.0f, 0.1f, 0.5f, 1.0f}) {
            const SchlickMetal<Rgb> metal = metal_of_edge(Rgb(normal), Rgb(edge));
            for (int i = 0; i <= 100; ++i) {
                const float f = schlick_reflectance(static_cast<float>(i) / 100, metal).r;
                EXPECT_TRUE(f >= 0 && f <= 1 + 1e-6f) << normal << " " << edge << " " << i;
            }
        }
}

TEST(SchlickMetal, MayBeTheSameAtAllAngles) {
    const SchlickMetal<Rgb> even{Rgb(0.3f), Rgb(0.3f), Rgb(0)};
    for (const float c : {0.0f, 0.2f, 1.0f}) EXPECT_EQ(schlick_reflectance(c, even), Rgb(0.3f));
}

}  // namespace
}  // namespace covtrace
