#include "texture/image_spectrum.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstring>
#include <functional>

#include "core/parallel.h"
#include "core/rng.h"

namespace covtrace {
namespace {

using Wrap = ImageSpectrum::Wrap;

struct Picture {
    int width = 0, height = 0;
    std::vector<float> values;

    Picture(int columns, int rows, const std::function<float(float, float)>& at)
        : width(columns), height(rows) {
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < columns; ++x)
                values.push_back(at(float(x) + 0.5f, float(y) + 0.5f));
    }
    ImageSpectrum spectrum(Wrap wrap) const { return {values, width, height, wrap}; }
};

/// The covariance per texel^2 at the centre of texel (x, y).
SpatialCovariance2 per_texel(const ImageSpectrum& s, const Picture& p, int x, int y) {
    const auto w = float(p.width), h = float(p.height);
    const SpatialCovariance2 c = s.at((float(x) + 0.5f) / w, (float(y) + 0.5f) / h);
    return {c.ss / (w * w), c.st / (w * h), c.tt / (h * h)};
}

/// White noise under a periodic Gaussian filter; its amplitude spectrum is a Gaussian with the
/// variances 1 / (4 pi^2 std^2). `along` is the direction of std_a, mean 0.5.
Picture noise(int size, float std_a, float std_b, Vec2 along, float contrast, uint64_t seed) {
    const auto n = size_t(size);
    Rng rng(seed);
    std::vector<float> white(n * n), sum(n * n);
    for (float& v : white) v = rng.next_float() - 0.5f;
    const int r = int(std::ceil(4 * std::max(std_a, std_b)));
    for (int j = -r; j <= r; ++j)
        for (int i = -r; i <= r; ++i) {
            const float a = (along.x * float(i) + along.y * float(j)) / std_a;
            const float b = (along.x * float(j) - along.y * float(i)) / std_b;
            const float weight = std::exp(-0.5f * (a * a + b * b));
            if (weight < 3e-4f) continue;
            for (size_t y = 0; y < n; ++y)
                for (size_t x = 0; x < n; ++x)
                    sum[y * n + x] += weight * white[(y + n + size_t(j + int(n))) % n * n +
                                                     (x + n + size_t(i + int(n))) % n];
        }
    double square = 0;
    for (float v : sum) square += double(v) * v;
    const float scale = contrast * 0.5f / float(std::sqrt(square / double(n * n)));
    return {size, size,
            [&](float x, float y) { return 0.5f + scale * sum[size_t(y) * n + size_t(x)]; }};
}

SpatialCovariance2 mean_per_texel(const Picture& p) {
    const ImageSpectrum s = p.spectrum(Wrap::repeat);
    double ss = 0, st = 0, tt = 0;
    for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x) {
            const SpatialCovariance2 c = per_texel(s, p, x, y);
            ss += double(c.ss);
            st += double(c.st);
            tt += double(c.tt);
        }
    const double n = double(p.values.size());
    return {float(ss / n), float(st / n), float(tt / n)};
}

TEST(ImageSpectrum, IsZeroForConstantImages) {
    for (const float value : {0.0f, 1e-6f, 0.7f, 3e5f}) {
        const Picture p(37, 21, [&](float, float) { return value; });
        for (const Wrap wrap : {Wrap::repeat, Wrap::clamp, Wrap::repeat_s}) {
            const SpatialCovariance2 c = p.spectrum(wrap).at(0.3f, 0.8f);
            EXPECT_EQ(c.ss, 0);
            EXPECT_EQ(c.st, 0);
            EXPECT_EQ(c.tt, 0);
        }
    }
    EXPECT_EQ(ImageSpectrum().at(0.5f, 0.5f).ss, 0);
}

TEST(ImageSpectrum, SeesAStraightEdgeFromAnyDistance) {
    struct Sides {
        float left, right;
    };
    for (const Sides sides : {Sides{0.2f, 0.8f}, Sides{0.8f, 0.02f}, Sides{0, 1}}) {
        const Picture p(512, 256,
                        [&](float x, float) { return x < 256 ? sides.left : sides.right; });
        const ImageSpectrum s = p.spectrum(Wrap::clamp);
        for (int d = 1; d <= 64; ++d)
            for (const int x : {255 - d, 256 + d}) {
                const SpatialCovariance2 c = per_texel(s, p, x, 128);
                // The texel's centre is half a texel further away than its number says.
                const float expected = 1 / (2 * kPi * 0.5f * (float(d) + 0.5f));
                EXPECT_GT(std::sqrt(c.ss), expected / 2) << "distance " << d << " at " << x;
                EXPECT_LT(std::sqrt(c.ss), expected * 2) << "distance " << d << " at " << x;
                EXPECT_LT(c.tt, 0.11f * c.ss);
                EXPECT_LT(std::abs(c.st), 0.01f * c.ss);
            }
    }
}

TEST(ImageSpectrum, TurnsWithTheEdge) {
    for (const float degrees : {20.0f, 45.0f, 110.0f, 160.0f}) {
        const Vec2 n{std::cos(degrees * kPi / 180), std::sin(degrees * kPi / 180)};
        const Picture p(256, 256, [&](float x, float y) {
            return 0.2f + 0.6f * clamp01(0.5f + dot(n, {x - 128, y - 128}));
        });
        const ImageSpectrum s = p.spectrum(Wrap::clamp);
        for (const float d : {4.0f, 10.0f, 30.0f}) {
            const SpatialCovariance2 c = per_texel(s, p, int(128 + d * n.x), int(128 + d * n.y));
            const float across = n.x * n.x * c.ss + 2 * n.x * n.y * c.st + n.y * n.y * c.tt;
            const float along = n.y * n.y * c.ss - 2 * n.x * n.y * c.st + n.x * n.x * c.tt;
            const float expected = 1 / (kPi * d);
            EXPECT_GT(std::sqrt(across), expected / 2) << degrees << " degrees, distance " << d;
            EXPECT_LT(std::sqrt(across), expected * 2) << degrees << " degrees, distance " << d;
            EXPECT_LT(along, 0.15f * across) << degrees << " degrees, distance " << d;
        }
    }
}

TEST(ImageSpectrum, CountsFaintEdgesLess) {
    const auto at_edge = [](float contrast) {
        const Picture p(128, 128,
                        [&](float x, float) { return x < 64 ? 1 - contrast : 1 + contrast; });
        return per_texel(p.spectrum(Wrap::clamp), p, 68, 64).ss;
    };
    EXPECT_LT(at_edge(0.02f), 0.1f * at_edge(0.3f));
    EXPECT_LT(at_edge(0.002f), 0.02f * at_edge(0.02f));
}

TEST(ImageSpectrum, MatchesTheAmplitudeSpectrumOfNoise) {
    for (const float std : {1.0f, 2.0f, 4.0f}) {
        const SpatialCovariance2 c = mean_per_texel(noise(256, std, std, {1, 0}, 0.3f, 1));
        const float expected = 1 / sqr(2 * kPi * std);
        EXPECT_NEAR(c.ss / expected, 1, 0.15) << "std " << std;
        EXPECT_NEAR(c.tt / expected, 1, 0.15) << "std " << std;
        EXPECT_NEAR(c.st / expected, 0, 0.05) << "std " << std;
    }
}

TEST(ImageSpectrum, SeesTheDirectionOfAnisotropicNoise) {
    // The texture is long along (1, 1) and varies across it, so that the cross term is negative.
    const float r = std::sqrt(0.5f);
    const SpatialCovariance2 c = mean_per_texel(noise(256, 4, 2, {r, r}, 0.3f, 2));
    const float wide = 1 / sqr(2 * kPi * 2), narrow = 1 / sqr(2 * kPi * 4);
    EXPECT_NEAR(c.ss / (0.5f * (wide + narrow)), 1, 0.2);
    EXPECT_NEAR(c.tt / (0.5f * (wide + narrow)), 1, 0.2);
    EXPECT_NEAR(c.st / (0.5f * (narrow - wide)), 1, 0.25);
}

TEST(ImageSpectrum, LiesBetweenTheSquareOfASinusoidsFrequencyAndTwiceThat) {
    for (const float contrast : {0.3f, 0.5f})
        for (const float period : {4.0f, 8.0f, 16.0f, 32.0f, 64.0f}) {
            const Picture p(512, 64, [&](float x, float) {
                return 1 + contrast * std::sin(2 * kPi * x / period);
            });
            const ImageSpectrum s = p.spectrum(Wrap::repeat);
            for (int x = 0; x < 512; ++x) {
                const float f2 = per_texel(s, p, x, 32).ss * sqr(period);
                EXPECT_GE(f2, 1) << "period " << period << " at " << x;
                EXPECT_LE(f2, 2) << "period " << period << " at " << x;
            }
        }
}

TEST(ImageSpectrum, IsSmallOnARamp) {
    const Picture p(512, 512, [](float x, float y) { return 0.2f + 0.001f * x + 0.0005f * y; });
    const SpatialCovariance2 c = per_texel(p.spectrum(Wrap::clamp), p, 256, 256);
    const float filter_std = 1 / (4 * kPi * std::sqrt(c.ss + c.tt));
    EXPECT_GT(filter_std, 40);  // of 512 texels; a ramp bears any filter
}

TEST(ImageSpectrum, ScalesWithUnitsNotWithBrightness) {
    const auto wave = [](float x, float y) { return 1 + 0.5f * std::sin(0.4f * x + 0.2f * y); };
    const Picture p(200, 100, wave);
    const SpatialCovariance2 c = p.spectrum(Wrap::clamp).at(0.4f, 0.6f);
    for (const float factor : {1e-4f, 1e5f}) {
        const Picture brighter(200, 100, [&](float x, float y) { return factor * wave(x, y); });
        const SpatialCovariance2 b = brighter.spectrum(Wrap::clamp).at(0.4f, 0.6f);
        EXPECT_NEAR(b.ss / c.ss, 1, 1e-3);
        EXPECT_NEAR(b.st / c.st, 1, 1e-3);
        EXPECT_NEAR(b.tt / c.tt, 1, 1e-3);
    }
    // The waves of 0.4 radians per texel are 0.4 * 200 / (2 pi) cycles per unit of s.
    EXPECT_GT(c.ss, sqr(0.4f * 200 / (2 * kPi)));
    EXPECT_LT(c.ss, 2.3f * sqr(0.4f * 200 / (2 * kPi)));
    EXPECT_GT(c.st, 0);
}

TEST(ImageSpectrum, KeepsItsUnitsWhereLargeImagesAreReduced) {
    const int size = 3 * ImageSpectrum::kMaxAnalysedSize - 5;
    const float cycles = 100;
    const Picture p(size, 6, [&](float x, float) {
        return 1 + 0.3f * std::sin(2 * kPi * cycles * x / float(size));
    });
    const ImageSpectrum s = p.spectrum(Wrap::repeat);
    for (const float at : {0.1f, 0.35f, 0.9f}) {
        EXPECT_GE(std::sqrt(s.at(at, 0.5f).ss), cycles);
        EXPECT_LE(std::sqrt(s.at(at, 0.5f).ss), cycles * 1.45f);
    }
    // The memory is that of 2048 by 2 texels at most: their means, and their spectra.
    EXPECT_LE(s.memory(), size_t(ImageSpectrum::kMaxAnalysedSize) * 2 * 16);
}

TEST(ImageSpectrum, SeesTheSeamOfARepeatedImageOnly) {
    const Picture p(128, 128, [](float x, float) { return 0.2f + 0.6f * x / 128; });
    const auto near_seam = [&](Wrap wrap) { return per_texel(p.spectrum(wrap), p, 1, 64); };
    EXPECT_GT(near_seam(Wrap::repeat).ss, 100 * near_seam(Wrap::clamp).ss);
    EXPECT_GT(near_seam(Wrap::repeat_s).ss, 100 * near_seam(Wrap::clamp).ss);
    const Picture q(128, 128, [](float, float y) { return 0.2f + 0.6f * y / 128; });
    EXPECT_GT(per_texel(q.spectrum(Wrap::repeat), q, 64, 1).tt,
              100 * per_texel(q.spectrum(Wrap::repeat_s), q, 64, 1).tt);
    EXPECT_GT(per_texel(q.spectrum(Wrap::repeat_t), q, 64, 1).tt,
              100 * per_texel(q.spectrum(Wrap::repeat_s), q, 64, 1).tt);
    EXPECT_GT(near_seam(Wrap::repeat).ss, 100 * near_seam(Wrap::repeat_t).ss);
}

TEST(ImageSpectrum, SaysTheSameInWhateverOrderItIsAsked) {
    const Picture p = noise(128, 2, 1, {0.6f, 0.8f}, 0.4f, 4);
    const ImageSpectrum finest_first = p.spectrum(Wrap::repeat);
    const ImageSpectrum coarse_first = p.spectrum(Wrap::repeat);
    const auto ask = [](const ImageSpectrum& s, float texels) {
        return s.at(0.3f, 0.4f, {texels / 128, texels / 128});
    };
    for (float texels : {1.0f, 2.5f, 20.0f}) ask(finest_first, texels);
    for (float texels : {20.0f, 2.5f, 1.0f}) {
        const SpatialCovariance2 a = ask(coarse_first, texels), b = ask(finest_first, texels);
        EXPECT_EQ(a.ss, b.ss);
        EXPECT_EQ(a.st, b.st);
        EXPECT_EQ(a.tt, b.tt);
    }
}

TEST(ImageSpectrum, DoesNotDependOnTheNumberOfThreads) {
    const Picture p = noise(128, 2, 1, {0.6f, 0.8f}, 0.4f, 3);
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        const ImageSpectrum s = p.spectrum(Wrap::repeat);
        std::vector<SpatialCovariance2> cells;
        for (int i = 0; i < 1000; ++i) cells.push_back(s.at(0.001f * float(i), 0.0007f * float(i)));
        return cells;
    };
    const auto one = run(1), three = run(3);
    EXPECT_EQ(std::memcmp(one.data(), three.data(), one.size() * sizeof(one[0])), 0);
}

RC_GTEST_PROP(ImageSpectrum, IsFiniteAndPositiveSemidefinite, ()) {
    const int width = *rc::gen::inRange(1, 40), height = *rc::gen::inRange(1, 40);
    const auto wrap = *rc::gen::element(Wrap::repeat, Wrap::clamp, Wrap::repeat_s);
    // The images are flat to high dynamic range, with black texels.
    const float range = *rc::gen::element(1e-3f, 1.0f, 10.0f);
    Rng rng(*rc::gen::arbitrary<uint64_t>());
    const Picture p(width, height, [&](float, float) {
        const float u = rng.next_float();
        return u < 0.2f ? 0.0f : std::exp(range * (u - 0.5f));
    });
    const ImageSpectrum s = p.spectrum(wrap);
    for (const float a : {0.0f, 0.21f, 0.5f, 1.0f, -3.7f, 1e30f, kInfinity, std::nanf("")})
        for (const float b : {0.0f, 0.77f, 1.0f, -kInfinity, 12.3f}) {
            const SpatialCovariance2 c = s.at(a, b);
            RC_ASSERT(std::isfinite(c.ss) && std::isfinite(c.st) && std::isfinite(c.tt));
            RC_ASSERT(c.ss >= 0 && c.tt >= 0);
            RC_ASSERT(sqr(c.st) <= c.ss * c.tt * 1.0001f);
        }
}

}  // namespace
}  // namespace covtrace
