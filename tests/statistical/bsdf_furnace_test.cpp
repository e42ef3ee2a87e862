/// The losses of GGX without multiple scattering: the figures that ggx.h states.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "bsdf/bsdf.h"
#include "core/rng.h"

namespace covtrace {
namespace {

constexpr int kSide = 256;

/// Share of the energy that a perfectly reflecting rough mirror or a rough glass border keeps.
double kept(const Bsdf& bsdf, Vec3 wo, Rng& rng) {
    double sum = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const Vec2 u{(static_cast<float>(i % kSide) + rng.next_float()) / kSide,
                     (static_cast<float>(i / kSide) + rng.next_float()) / kSide};
        const auto s = sample(bsdf, wo, rng.next_float(), u);
        if (s) sum += s->weight.g * s->eta * s->eta;
    }
    return sum / (kSide * kSide);
}

Vec3 at_cos(float cos_theta) {
    return {std::sqrt(1 - cos_theta * cos_theta), 0, cos_theta};
}

/// Cosine-weighted mean over incidence of the share that is kept.
double mean_kept(const Bsdf& bsdf) {
    constexpr int kCosines = 8;
    Rng rng(5);
    double sum = 0;
    for (int i = 0; i < kCosines; ++i)
        sum += kept(bsdf, at_cos(std::sqrt((static_cast<float>(i) + 0.5f) / kCosines)), rng);
    return sum / kCosines;
}

// A mirror that reflects perfectly: k is so large that Fresnel is 1 within the tolerance.
Bsdf white_mirror(float alpha) {
    return ConductorBsdf{Rgb(1e-3f), Rgb(1e3f), alpha, alpha};
}

struct Bound {
    float alpha;
    double least;
};

TEST(GgxFurnace, RoughMirrorKeepsWhatIsStated) {
    double before = 1.001;
    for (const Bound& b : {Bound{0.1f, 0.97}, {0.3f, 0.84}, {0.5f, 0.69}, {1.0f, 0.40}}) {
        const double mean = mean_kept(white_mirror(b.alpha));
        std::printf("GGX mirror, alpha %.2f: keeps %.4f of the energy\n",
                    static_cast<double>(b.alpha), mean);
        EXPECT_GE(mean, b.least);
        EXPECT_LE(mean, before);
        before = mean;
    }
}

TEST(GgxFurnace, RoughGlassKeepsWhatIsStated) {
    const std::array<float, 4> alphas{0.1f, 0.3f, 0.5f, 1.0f};
    const std::array<double, 4> from_outside{0.99, 0.96, 0.92, 0.79},
        from_inside{0.96, 0.82, 0.69, 0.48};
    double outside_before = 1.001, inside_before = 1.001;
    for (size_t i = 0; i < alphas.size(); ++i) {
        const double outside = mean_kept(DielectricBsdf{1.5f, alphas[i], alphas[i]});
        const double inside = mean_kept(DielectricBsdf{1 / 1.5f, alphas[i], alphas[i]});
        std::printf("GGX glass, alpha %.2f: keeps %.4f from outside, %.4f from inside\n",
                    static_cast<double>(alphas[i]), outside, inside);
        EXPECT_GE(outside, from_outside[i]);
        EXPECT_GE(inside, from_inside[i]);
        EXPECT_LE(outside, outside_before);
        EXPECT_LE(inside, inside_before);
        outside_before = outside;
        inside_before = inside;
    }
}

}  // namespace
}  // namespace covtrace
