// Patch distances are as defined, for one channel and three, up to the image's border.
#include "reconstruction/patch_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace covtrace {
namespace {

constexpr int kWidth = 61, kHeight = 54;  // more than a block each way

Plane random_plane(unsigned seed, float least, float most) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(least, most);
    Plane p(kWidth, kHeight);
    for (float& v : p.values) v = value(random);
    return p;
}

/// The distance by its definition, the patch around both pixels with the outermost pixels repeated.
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

template <int Radius, int Step, int Side>
void expect_as_defined(size_t channels) {
    std::vector<Plane> values, variances;
    for (unsigned c = 0; c < channels; ++c) {
        values.push_back(random_plane(c, 0, 1));
        variances.push_back(random_plane(10 + c, 0.05f, 0.5f));
    }
    using Patches = PatchDistance<Radius, Step, Side>;
    constexpr int kReach = 5, kBlock = Patches::kBlock, kPatches = Patches::kPatches;
    const Patches distance(values, variances, kReach);
    for (const size_t stride : {1, 3})
        for (const auto& [dx, dy] : {std::pair{0, 0}, {3, -5}, {-5, 2}})
            for (const auto& [x0, y0] : {std::pair{0, 0}, {kBlock, 0}, {0, kBlock}}) {
                std::vector<float> d(size_t(kPatches) * kPatches * stride);
                distance.block(x0, y0, dx, dy, d.data(), stride);
                for (int y = 0; y < kPatches && y0 + y * Step < kHeight; ++y)
                    for (int x = 0; x < kPatches && x0 + x * Step < kWidth; ++x) {
                        const int px = x0 + x * Step, py = y0 + y * Step;
                        ASSERT_NEAR(d[size_t(y * kPatches + x) * stride],
                                    expected(values, variances, Radius, px, py, px + dx, py + dy),
                                    1e-4)
                            << px << " " << py << " " << dx << " " << dy;
                    }
            }
}

TEST(PatchDistance, IsAsDefined) {
    expect_as_defined<3, 1, 32>(1);
    expect_as_defined<3, 1, 32>(3);
    expect_as_defined<1, 3, 48>(3);
}

}  // namespace
}  // namespace covtrace
