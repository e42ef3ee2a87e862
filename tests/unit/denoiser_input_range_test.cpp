#include "denoiser/input_range.h"

#include <gtest/gtest.h>

#include "tests/denoiser/noisy_images.h"

namespace covtrace {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

TEST(InputRange, LightComesBackBitByBit) {
    for (float scale : {1e-30f, 1.0f, 1e30f}) {
        NoisyView image = noisy_view(20, 10);
        for (Plane& channel : image.color)
            for (float& v : channel.values) v *= scale;
        const InputRange range(image.color);
        for (float v : image.color[0].values) {
            EXPECT_LT(range.to_network(v), 4);
            EXPECT_EQ(range.from_network(range.to_network(v)), v);
        }
    }
}

TEST(InputRange, ValuesFarBeyondTheOthersAreLimited) {
    NoisyView image = noisy_view(20, 10);
    set_pixel(image.color, 3, 4, 1e30f);
    const InputRange range(image.color);
    EXPECT_EQ(range.to_network(1e30f), 1e4f);
    EXPECT_EQ(range.to_network(kInfinite), 1e4f);
    EXPECT_EQ(range.to_network(-kInfinite), -1e4f);
    EXPECT_EQ(range.to_network(std::nanf("")), 0);
    EXPECT_LT(range.to_network(1), 2);
    EXPECT_GT(range.to_network(1), 0.05f);
}

TEST(InputRange, NothingComesBackInfinite) {
    NoisyView image = noisy_view(20, 10);
    for (Plane& channel : image.color)
        for (float& v : channel.values) v = std::numeric_limits<float>::max();
    EXPECT_TRUE(std::isfinite(InputRange(image.color).from_network(1e4f)));
}

TEST(InputRange, BlackImages) {
    const Plane black(4, 4);
    const InputRange range({black, black, black});
    EXPECT_TRUE(range.is_dark());
    EXPECT_FALSE(InputRange(noisy_view(4, 4).color).is_dark());
}

TEST(InputRange, Features) {
    const InputRange range;
    EXPECT_EQ(range.to_network(0.3f), 0.3f);
    EXPECT_EQ(range.to_network(-0.3f), -0.3f);
    EXPECT_EQ(range.to_network(7), 1);
    EXPECT_EQ(range.to_network(-kInfinite), -1);
    EXPECT_EQ(range.to_network(std::nanf("")), 0);
}

}  // namespace
}  // namespace covtrace
