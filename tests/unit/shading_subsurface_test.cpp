// Media of bodies that scatter light inside.
#include <gtest/gtest.h>

#include "bsdf/coat_table.h"
#include "shading/subsurface.h"

namespace covtrace {
namespace {

TEST(Subsurface, MediaSendBackWhatTheyAreMadeFor) {
    for (const Entry entry : {Entry::diffuse, Entry::perpendicular})
        for (const float inside : {0.0f, 0.6f})
            for (const float g : {-0.5f, 0.0f, 0.9f})
                for (const Rgb reflectance : {Rgb(0, 0.01f, 0.2f), Rgb(0.5f, 0.9f, 0.99f)}) {
                    const Scattering s =
                        scattering_of_reflectance(reflectance, {1, 2, 0.1f}, g, inside, entry);
                    const Rgb back = reflectance_of_scattering(s, g, inside, entry);
                    for (int c = 0; c < 3; ++c) {
                        // Single precision keeps few digits of what white media absorb
                        EXPECT_NEAR(back[c], reflectance[c],
                                    reflectance[c] > 0.95f ? 2e-3f : 1e-4f);
                    }
                    EXPECT_NEAR(s.absorption.r + s.scattering.r, 1, 1e-5f);
                    EXPECT_NEAR(s.absorption.g + s.scattering.g, 0.5f, 1e-5f);
                    EXPECT_NEAR(s.absorption.b + s.scattering.b, 10, 1e-4f);
                }
}

TEST(Subsurface, WhiteBodiesAbsorbNothingAndBlackOnesScatterNothing) {
    const Scattering s = scattering_of_reflectance({1, 0, 2}, {1, 1, 1}, 0, 0, Entry::diffuse);
    EXPECT_EQ(s.absorption.r, 0);
    EXPECT_EQ(s.absorption.b, 0);
    EXPECT_NEAR(s.scattering.g, 0, 1e-6f);
    EXPECT_EQ(reflectance_of_scattering({{1, 0, 1}, {0, 0, 0}}, 0, 0, Entry::diffuse), Rgb(0));
}

TEST(Subsurface, ShortestPathsStayNumbers) {
    const Scattering s =
        scattering_of_reflectance(Rgb(0.5f), {0, 1e-30f, 1e30f}, 0, 0, Entry::diffuse);
    EXPECT_TRUE(is_finite(s.absorption) && is_finite(s.scattering));
}

// Darkness of what is met by the border from inside: 1 - (1 - F) / eta^2 with the diffuse
// reflectance F = 0.0918 of index 1.5 (Jensen, Marschner, Levoy and Hanrahan 2001: 0.596).
TEST(Subsurface, BordersReflectInside) {
    const CoatTable table(1.5f, 0);
    EXPECT_NEAR(inner_reflectance(make_coated_total(table, Rgb(0.5f), 0, 0)), 0.596f, 0.002f);
    const CoatTable none(1, 0);
    EXPECT_NEAR(inner_reflectance(make_coated_total(none, Rgb(0.5f), 0, 0)), 0, 1e-6f);
}

}  // namespace
}  // namespace covtrace
