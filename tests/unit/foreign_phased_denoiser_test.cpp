// Denoising every second row and column by itself: which pixels go together, and that they return.
#include "foreign/phased_denoiser.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>

namespace covtrace {
namespace {

/// Replaces an image by its mean, and adds a hundredth of the albedo's.
class MeanDenoiser : public Denoiser {
  public:
    std::string name() const override { return "mean"; }
    size_t memory(size_t pixels) const override { return pixels; }
    std::vector<ColorPlanes> denoise(const NoisyFeatures& features,
                                     std::vector<NoisyImage> images) const override {
        std::vector<ColorPlanes> results;
        for (const NoisyImage& image : images) {
            turned_ += image.turned;
            ColorPlanes result = image.color;
            for (size_t c = 0; c < 3; ++c) {
                EXPECT_EQ(features.albedo[c].size(), result[c].size());
                const float value = mean(image.color[c]) + 0.01f * mean(features.albedo[c]);
                for (float& v : result[c].values) v = value;
            }
            results.push_back(std::move(result));
        }
        return results;
    }
    int turned() const { return turned_; }

  private:
    static float mean(const Plane& p) {
        double sum = 0;
        for (float v : p.values) sum += double(v);
        return float(sum / double(p.size()));
    }
    mutable int turned_ = 0;
};

TEST(PhasedDenoiser, PixelsTwoApartAreOnePicture) {
    // An odd size, so that the four pictures have different sizes
    for (const auto [w, h] : {std::array{7, 5}, std::array{8, 6}, std::array{1, 3}}) {
        NoisyFeatures features;
        NoisyImage image;
        for (size_t c = 0; c < 3; ++c) {
            features.normal[c] = Plane(w, h);
            features.albedo[c] = image.color[c] = Plane(w, h);
            for (int y = 0; y < h; ++y)
                for (int x = 0; x < w; ++x) {
                    image.color[c](x, y) = float(1 + int(c) + 10 * (x % 2) + 100 * (y % 2));
                    features.albedo[c](x, y) = float(x % 2);
                }
        }
        NoisyImage turned = image;
        turned.turned = true;
        const MeanDenoiser mean;
        const std::vector<ColorPlanes> clean =
            PhasedDenoiser(mean).denoise(features, {image, turned});
        ASSERT_EQ(clean.size(), 2u);
        EXPECT_EQ(mean.turned(), std::min(2, w) * std::min(2, h));
        for (const ColorPlanes& result : clean)
            for (size_t c = 0; c < 3; ++c)
                for (int y = 0; y < h; ++y)
                    for (int x = 0; x < w; ++x)
                        EXPECT_FLOAT_EQ(result[c](x, y),
                                        image.color[c](x, y) + 0.01f * float(x % 2))
                            << w << " " << x << " " << y;
    }
}

TEST(PhasedDenoiser, HoldsAQuarterAtATime) {
    const MeanDenoiser mean;
    EXPECT_LE(PhasedDenoiser(mean).memory(1000), 251u);
    EXPECT_EQ(PhasedDenoiser(mean).name(), "mean");
}

}  // namespace
}  // namespace covtrace
