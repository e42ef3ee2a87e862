/// The standard observer's table, between its entries and as a whole.
#include <gtest/gtest.h>

#include "colour/standard_observer.h"

namespace covtrace::test {
namespace {

TEST(StandardObserver, IsItsTableAtEveryNanometre) {
    // Values of CIE's table by nanometres (ISO 11664-1), of which every fifth is stored.
    struct Known {
        double wavelength;
        TristimulusValues value;
    };
    for (const Known& k :
         {Known{381, {0.001502, 4.2826e-05, 0.0070832}}, Known{437, {0.33921, 0.019214, 1.6853}},
          Known{446, {0.34637, 0.031311, 1.783}}, Known{504, {0.0022363, 0.38929, 0.22345}},
          Known{555, {0.51205, 1, 0.00575}}, Known{599, {1.0629, 0.64384, 0.00084256}},
          Known{778, {4.7677e-05, 1.7217e-05, 0}}}) {
        const TristimulusValues v = matching_functions(k.wavelength);
        EXPECT_NEAR(v.x, k.value.x, 5e-4) << k.wavelength;
        EXPECT_NEAR(v.y, k.value.y, 3e-4) << k.wavelength;
        EXPECT_NEAR(v.z, k.value.z, 2.4e-3) << k.wavelength;
    }
    for (const double outside : {-1.0, 379.0, 781.0, 1e30}) {
        const TristimulusValues v = matching_functions(outside);
        EXPECT_EQ(v.x + v.y + v.z, 0) << outside;
    }
}

TEST(StandardObserver, SeesLightOfEqualEnergyWhite) {
    TristimulusValues sum;
    for (int l = 360; l <= 830; ++l) {
        const TristimulusValues v = matching_functions(l);
        sum = {sum.x + v.x, sum.y + v.y, sum.z + v.z};
    }
    // Sums of CIE's table by nanometres
    EXPECT_NEAR(sum.x, 106.865, 0.02);
    EXPECT_NEAR(sum.y, 106.857, 0.02);
    EXPECT_NEAR(sum.z, 106.892, 0.05);
}

}  // namespace
}  // namespace covtrace::test
