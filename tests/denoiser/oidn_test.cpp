// Open Image Denoise itself, where it is found.
#include <gtest/gtest.h>

#include "core/parallel.h"
#include "denoiser/find_denoiser.h"
#include "tests/denoiser/noisy_images.h"

namespace covtrace {
namespace {

class Oidn : public testing::Test {
  protected:
    void SetUp() override {
        found_ = find_denoiser({DenoiserChoice::automatic, {}, {COVTRACE_DENOISER_FOLDER}});
        if (!found_.denoiser) GTEST_SKIP() << found_.why_none;
    }
    ColorPlanes denoised(const NoisyView& image) const {
        return covtrace::denoised(*found_.denoiser, image);
    }
    static float mean(const Plane& p) {
        double sum = 0;
        for (float v : p.values) sum += double(v);
        return float(sum / double(p.size()));
    }

    FoundDenoiser found_;
};

TEST_F(Oidn, TakesNoiseAway) {
    const NoisyView image = noisy_view(96, 64);
    const ColorPlanes clean = denoised(image);
    for (int x = 8; x < 88; ++x) {
        const float truth = 0.1f + 1.9f * float(x) / 96;
        EXPECT_NEAR(clean[1](x, 32), truth, 0.5f * truth) << x;
    }
    EXPECT_NEAR(mean(clean[1]), mean(image.color[1]), 0.1f * mean(image.color[1]));
}

TEST_F(Oidn, TakesNoiseAwayWithoutFeatures) {
    const Plane black(96, 64);
    for (bool albedo : {false, true}) {
        NoisyView image = noisy_view(96, 64);
        if (!albedo) image.features.albedo.fill(black);
        image.features.normal.fill(black);
        const ColorPlanes clean = denoised(image);
        for (int x = 8; x < 88; ++x) {
            const float truth = 0.1f + 1.9f * float(x) / 96;
            EXPECT_NEAR(clean[1](x, 32), truth, 0.5f * truth) << x;
        }
    }
}

TEST_F(Oidn, SizesOfAllKinds) {
    for (auto [width, height] : {std::pair(1, 1), {3, 2}, {400, 1}, {1, 400}, {17, 15}}) {
        const ColorPlanes clean = denoised(noisy_view(width, height));
        EXPECT_EQ(clean[0].width, width);
        EXPECT_EQ(clean[0].height, height);
        EXPECT_TRUE(is_finite(clean)) << width << "x" << height;
        EXPECT_LT(largest(clean), 20) << width << "x" << height;
    }
}

TEST_F(Oidn, ATurnedImageIsTurnedBack) {
    const NoisyView view = noisy_view(97, 64);
    const ColorPlanes clean = denoised(view),
                      turned = covtrace::denoised(*found_.denoiser, view, true);
    double difference = 0, sum = 0;
    for (size_t i = 0; i < clean[0].size(); ++i) {
        difference += double(std::abs(turned[0][i] - clean[0][i]));
        sum += double(clean[0][i]);
    }
    EXPECT_GT(difference, 0);
    EXPECT_LT(difference, 0.05 * sum);
}

TEST_F(Oidn, BlackStaysBlack) {
    NoisyView image = noisy_view(64, 48);
    for (Plane& channel : image.color) channel = Plane(64, 48);
    EXPECT_EQ(largest(denoised(image)), 0);
}

TEST_F(Oidn, DarkAndBrightImagesAreAlike) {
    const NoisyView image = noisy_view(64, 48);
    const ColorPlanes clean = denoised(image);
    for (float scale : {1e-30f, 1e-12f, 1e-3f, 1e6f, 1e30f}) {
        NoisyView other = image;
        for (Plane& channel : other.color)
            for (float& v : channel.values) v *= scale;
        const ColorPlanes its = denoised(other);
        for (size_t i = 0; i < clean[0].size(); ++i)
            ASSERT_NEAR(its[0][i] / scale, clean[0][i], 1e-3f * clean[0][i]) << scale;
    }
}

TEST_F(Oidn, OnePixelDoesNotSpread) {
    const NoisyView image = noisy_view(96, 64);
    const ColorPlanes clean = denoised(image);
    constexpr float kInfinite = std::numeric_limits<float>::infinity();
    for (float value : {1e5f, 1e30f, kInfinite, -kInfinite, std::nanf("")}) {
        NoisyView other = image;
        set_pixel(other.color, 40, 30, value);
        const ColorPlanes its = denoised(other);
        ASSERT_TRUE(is_finite(its)) << value;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 96; ++x)
                if (std::max(std::abs(x - 40), std::abs(y - 30)) > 12)
                    ASSERT_NEAR(its[1](x, y), clean[1](x, y), 0.5f * clean[1](x, y))
                        << value << " at " << x << "," << y;
    }
}

TEST_F(Oidn, FeaturesThatAreNoNumbers) {
    NoisyView image = noisy_view(48, 32);
    image.features.albedo[0](5, 5) = std::nanf("");
    image.features.normal[2](20, 5) = std::numeric_limits<float>::infinity();
    image.features.normal[1](30, 5) = 1e30f;
    EXPECT_TRUE(is_finite(denoised(image)));
}

TEST_F(Oidn, ThreadsAndOtherImagesDoNotMatter) {
    const NoisyView image = noisy_view(150, 130);
    std::vector<ColorPlanes> results, drafts;
    for (int threads : {1, 2, 3, 8}) {
        const ThreadLimit limit(threads);
        const FoundDenoiser found = find_denoiser({DenoiserChoice::oidn, found_.library, {}});
        results.push_back(covtrace::denoised(*found.denoiser, image));
        std::vector<ColorPlanes> both = found.denoiser->denoise(
            image.features,
            {{.color = noisy_view(150, 130, 2).color, .turned = true, .draft = true},
             {.color = image.color}});
        drafts.push_back(std::move(both[0]));
        results.push_back(std::move(both[1]));
    }
    for (const std::vector<ColorPlanes>& alike : {results, drafts})
        for (const ColorPlanes& result : alike)
            for (size_t c = 0; c < 3; ++c) EXPECT_EQ(result[c].values, alike[0][c].values);
}

}  // namespace
}  // namespace covtrace
