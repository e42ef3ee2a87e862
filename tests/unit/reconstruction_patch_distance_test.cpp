// Patch distances are as defined, for one channel and three, up to the image's border.
#include "reconstruction/patch_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace covtrace {
namespace {

constexpr int kWidth = 45, kHeight = 38;  // more than a block each way

Plane random_plane(unsigned seed, float least, float most) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(least, most);
    Plane p(kWidth, kHeight);
    for (float& v : p.values) v = value(random);
    return p;
}

/// Of the definition, the patch around both pixels with the outermost pixels repeated.
double expected(const std::vector<Plane>& values, const std::vector<Plane>& variances, int radius,
                int px, int py, int qx, int qy) {
    const auto at = [](const Plane& p, int x, int y) {
        return double(p(std::clamp(x, 0, kWidth - 1), std::clamp(y, 0, kHeight - 1)));
    };
    double sum = 0;
    for (int v = -radius; v <= radius; ++v)
        for (int u = -radius; u <= radius; ++u) {
            double difference = 0, of_p = 0, of_q = 0;
            for (size_t c = 0; c < values.size(); ++c) {
                const double d = at(values[c], px + u, py + v) - at(values[c], qx + u, qy + v);
                difference += d * d;
                of_p += at(variances[c], px + u, py + v);
                of_q += at(variances[c], qx + u, qy + v);
            }
            sum += (difference - of_p - std::min(of_p, of_q)) / (of_p + of_q);
        }
    return sum / ((2 * radius + 1) * (2 * radius + 1));
}

void expect_as_defined(size_t channels, int radius, int row_step) {
    std::vector<Plane> values, variances;
    for (unsigned c = 0; c < channels; ++c) {
        values.push_back(random_plane(c, 0, 1));
        variances.push_back(random_plane(10 + c, 0.05f, 0.5f));
    }
    constexpr int kReach = 5, kBlock = PatchDistance::kBlock;
    const PatchDistance distance(values, variances, kReach, radius, row_step);
    std::vector<float> d(size_t(kBlock) * kBlock);
    for (const auto& [dx, dy] : {std::pair{0, 0}, {3, -5}, {-5, 2}})
        for (const auto& [x0, y0] : {std::pair{0, 0}, {kBlock, 0}, {0, kBlock}}) {
            distance.block(x0, y0, dx, dy, d.data());
            for (int y = 0; y < kBlock && y0 + y < kHeight; y += row_step)
                for (int x = 0; x < kBlock && x0 + x < kWidth; ++x) {
                    const int px = x0 + x, py = y0 + y;
                    ASSERT_NEAR(d[size_t(y) * kBlock + size_t(x)],
                                expected(values, variances, radius, px, py, px + dx, py + dy), 1e-4)
                        << px << " " << py << " " << dx << " " << dy;
                }
        }
}

TEST(PatchDistance, IsAsDefined) {
    expect_as_defined(1, 3, 1);
    expect_as_defined(3, 3, 1);
    expect_as_defined(3, 1, 3);
}

}  // namespace
}  // namespace covtrace
