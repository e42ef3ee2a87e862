// Power of several shapes that one directive made.
#include <gtest/gtest.h>

#include "light_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

TEST(LightPower, IsThatOfAllThatOneDirectiveMade) {
    LightScene s;
    const size_t small = s.add(mesh_of(rectangle(1, 1)), Rgb(1));
    const size_t large = s.add(mesh_of(rectangle(3, 1)), Rgb(1));
    const size_t other = s.add(mesh_of(rectangle(1, 1)), Rgb(1));
    auto& shapes = s.description.shapes;
    shapes[large].area_light = shapes[other].area_light = shapes[small].area_light;
    shapes[small].directive = shapes[large].directive = 7;
    shapes[other].directive = 8;
    s.description.area_lights[0].power = 100.0f;
    s.build();
    const auto radiance = [&](size_t shape) {
        SurfaceHit hit;
        hit.shape = static_cast<uint32_t>(shape);
        hit.ng = {0, 0, 1};
        return s.lights->emitted(hit, {0, 0, 1}).r;
    };
    EXPECT_NEAR(radiance(small) * kPi * 4, 100, 1e-3f);
    EXPECT_NEAR(radiance(large) * kPi * 4, 100, 1e-3f);
    EXPECT_NEAR(radiance(other) * kPi, 100, 1e-3f);
}

}  // namespace
}  // namespace covtrace
