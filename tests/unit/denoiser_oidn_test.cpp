#include <gtest/gtest.h>

#include <cstdlib>

#include "core/error.h"
#include "denoiser/oidn_denoiser.h"
#include "tests/denoiser/noisy_images.h"

namespace covtrace {
namespace {

OidnDenoiser fake(const char* name) {
    return OidnDenoiser(std::filesystem::path(COVTRACE_FAKE_DENOISERS) / name /
                        "libOpenImageDenoise.so.2");
}

TEST(OidnDenoiser, GivesWhatTheLibraryMakesOfTheLight) {
    const OidnDenoiser denoiser = fake("good");
    const NoisyView image = noisy_view(9, 7);
    const std::vector<ColorPlanes> clean =
        denoiser.denoise(image.features, {{.color = image.color},
                                          {.color = noisy_view(9, 7, 2).color, .draft = true},
                                          {.color = image.color, .turned = true}});
    ASSERT_EQ(clean.size(), 3u);
    EXPECT_NE(clean[1][2].values, clean[0][2].values);
    for (size_t c = 0; c < 3; ++c) {
        const Plane expected = box_blur(image.color[c], 1);
        for (int y = 1; y < 6; ++y)
            for (int x = 1; x < 8; ++x)
                for (size_t k : {0, 2})  // a box has no upside
                    EXPECT_NEAR(clean[k][c](x, y), expected(x, y), 1e-5f * expected(x, y));
    }
}

TEST(OidnDenoiser, FeaturesThatAreNotKnownAreLeftOut) {
    const OidnDenoiser denoiser = fake("good");
    const Plane black(9, 7);
    const auto images_are = [&](const char* images, bool albedo, bool normal) {
        NoisyView view = noisy_view(9, 7);
        if (!albedo) view.features.albedo.fill(black);
        if (!normal) view.features.normal.fill(black);
        ::setenv("FAKE_OIDN_IMAGES", images, 1);
        EXPECT_NO_THROW(denoised(denoiser, view)) << images;
        ::setenv("FAKE_OIDN_IMAGES", "others", 1);
        EXPECT_THROW(denoised(denoiser, view), Error);
        ::unsetenv("FAKE_OIDN_IMAGES");
    };
    images_are("color albedo normal", true, true);
    images_are("color albedo", true, false);
    images_are("color", false, false);
    images_are("color", false, true);  // the library takes no normals without an albedo
}

TEST(OidnDenoiser, FeaturesAreCleanedUnlessTheyAreToBeTakenAsTheyAre) {
    const OidnDenoiser denoiser = fake("good");
    NoisyView view = noisy_view(9, 7);
    const auto features_are = [&](FeatureCleaning cleaning, const char* features) {
        view.features.cleaning = cleaning;
        for (const char* other : {"clean", "noisy"}) {
            ::setenv("FAKE_OIDN_FEATURES", other, 1);
            if (std::string(other) == features)
                EXPECT_NO_THROW(denoised(denoiser, view));
            else
                EXPECT_THROW(denoised(denoiser, view), Error);
            ::unsetenv("FAKE_OIDN_FEATURES");
        }
    };
    features_are(FeatureCleaning::thorough, "clean");
    features_are(FeatureCleaning::draft, "clean");
    features_are(FeatureCleaning::none, "noisy");
}

TEST(OidnDenoiser, DraftsTakeTheLeastQualityThatTheVersionHas) {
    constexpr const char *kFast = "4", *kBalanced = "5", *kHigh = "6";
    const auto quality_is = [](const char* library, bool draft, const char* quality) {
        const OidnDenoiser denoiser = fake(library);
        const NoisyView view = noisy_view(9, 7);
        ::setenv("FAKE_OIDN_QUALITY", quality, 1);
        EXPECT_NO_THROW(denoiser.denoise(view.features, {{.color = view.color, .draft = draft}}))
            << library << ", quality " << quality;
        ::unsetenv("FAKE_OIDN_QUALITY");
    };
    quality_is("good", true, kFast);
    quality_is("version-two", true, kBalanced);  // before 2.3 there is no faster one
    quality_is("good", false, kHigh);
    quality_is("version-two", false, kHigh);
}

TEST(OidnDenoiser, WhatIsNoNumberIsThePixelOfBefore) {
    const NoisyView image = noisy_view(9, 7);
    const ColorPlanes good = denoised(fake("good"), image),
                      damaged = denoised(fake("not-a-number"), image);
    for (size_t i = 0; i < image.color[0].size(); ++i) {
        const bool hit = 3 * i % 7 == 0 || (3 * i + 1) % 7 == 0 || (3 * i + 2) % 7 == 0;
        for (size_t c = 0; c < 3; ++c)
            EXPECT_EQ(damaged[c][i], hit ? image.color[c][i] : good[c][i]) << i;
    }
}

TEST(OidnDenoiser, ALibraryThatFailsIsAnErrorWithoutAPath) {
    try {
        denoised(fake("execute-fails"), noisy_view(4, 4));
        FAIL() << "no error";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::limit);
        EXPECT_STREQ(e.what(), "Open Image Denoise 2.3.99: the filter is out of order");
    }
}

}  // namespace
}  // namespace covtrace
