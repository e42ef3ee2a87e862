/// Coats whose reflectance is tinted: what they are for colours that need no tint, and their
/// energy.
#include <gtest/gtest.h>

#include "bsdf/coat_table.h"
#include "core/warp.h"

namespace covtrace {
namespace {

const CoatTable& table() {
    static const CoatTable t(1.5f, 0);
    return t;
}
CoatTint tint(Rgb normal_reflectance, float weight = 1) {
    static const CoatTable white(kWhiteIndex, 0);
    return {normal_reflectance, weight, &white};
}
Vec3 at_cos(float c) {
    return {std::sqrt(1 - c * c), 0, c};
}

/// Directional albedo by midpoints over the square of cosine-weighted directions.
Rgb integrated(const Bsdf& bsdf, Vec3 wo) {
    constexpr int kSide = 400;
    Rgb sum;
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
            const Vec3 wi =
                square_to_cosine_hemisphere({(float(i) + 0.5f) / kSide, (float(j) + 0.5f) / kSide});
            if (wi.z > 0) sum += eval(bsdf, wo, wi) / cosine_hemisphere_pdf(wi.z);
        }
    return sum / (kSide * kSide);
}

TEST(CoatTint, OfTheIndexItselfChangesNothing) {
    for (const float alpha : {0.0f, 0.1f, 0.6f}) {
        const Rgb tan(0.7f, 0.5f, 0.2f);
        const Bsdf plain = make_coated_total(table(), tan, alpha, alpha);
        const Bsdf same = make_coated_total(table(), tan, alpha, alpha, tint(Rgb(0.04f)));
        for (const float c : {0.05f, 0.4f, 0.9f}) {
            const Vec3 wo = at_cos(0.7f), wi = {-at_cos(c).x, 0.1f, at_cos(c).z};
            const Rgb a = eval(plain, wo, normalize(wi)), b = eval(same, wo, normalize(wi));
            for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-4f + 1e-3f * a[i]) << alpha;
        }
    }
}

TEST(CoatTint, GreyOnesKeepAllLight) {
    for (const auto& [r, weight] : {std::pair(0.04f, 0.5f), {0.3f, 1.0f}, {0.8f, 0.7f}, {0, 1}})
        for (const float alpha : {0.2f, 0.5f, 1.0f})
            for (const float cos_o : {0.3f, 0.7f, 1.0f}) {
                const Bsdf white =
                    make_coated_total(table(), Rgb(1), alpha, alpha, tint(Rgb(r), weight));
                EXPECT_NEAR(integrated(white, at_cos(cos_o)).g, 1, 0.01f)
                    << r << " " << weight << " " << alpha << " " << cos_o;
            }
}

TEST(CoatTint, AlbedoIsTheIntegral) {
    for (const float alpha : {0.3f, 0.8f}) {
        const Bsdf b = make_coated_total(table(), {0.6f, 0.3f, 0.1f}, alpha, alpha,
                                         tint({0.9f, 0.4f, 0}, 0.8f));
        for (const float cos_o : {0.3f, 0.9f}) {
            const Rgb found = albedo(b, at_cos(cos_o)), sum = integrated(b, at_cos(cos_o));
            for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], sum[i], 0.01f);
        }
    }
}

TEST(CoatTint, SmoothOnesReflectTheirColourAndWhiteAtTheRim) {
    const Bsdf b = make_coated_total(table(), Rgb(0), 0, 0, tint({0.9f, 0.4f, 0}, 0.8f));
    const auto mirrored = [&](float cos_o) {
        const auto s = sample(b, at_cos(cos_o), 0, {});
        return s ? s->weight * s->pdf : Rgb(-1);
    };
    const Rgb front = mirrored(1), rim = mirrored(1e-3f);
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(front[i], 0.8f * Rgb(0.9f, 0.4f, 0)[i], 1e-5f);
        EXPECT_NEAR(rim[i], 0.8f, 0.01f);
    }
}

TEST(CoatTint, FilmsHaveTheirColoursOverABaseThatGetsTheRest) {
    CoatTint filmed = tint(Rgb(0.04f));
    filmed.film = {1, 1.8f, 300};
    const Bsdf mirroring = make_coated_total(table(), Rgb(0), 0, 0, filmed);
    for (const float cos_o : {1.0f, 0.5f}) {
        const auto s = sample(mirroring, at_cos(cos_o), 0, {});
        ASSERT_TRUE(s);
        const Rgb found = s->weight * s->pdf,
                  expected = film_reflectance(filmed.film, cos_o, Rgb(0.04f));
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], 1e-6f);
        EXPECT_GT(max_component(expected), 1.2f * expected[cos_o == 1 ? 1 : 2]) << "has a colour";
    }
    // A white base keeps what the strongest colour leaves, which is known at the mean angle of the
    // facets alone
    for (const float alpha : {0.2f, 0.6f})
        for (const float cos_o : {0.3f, 0.7f, 1.0f}) {
            const Bsdf white = make_coated_total(table(), Rgb(1), alpha, alpha, filmed);
            const Rgb sum = integrated(white, at_cos(cos_o)), told = albedo(white, at_cos(cos_o));
            EXPECT_NEAR(max_component(sum), 1, 0.04f) << alpha << " " << cos_o;
            for (int i = 0; i < 3; ++i) EXPECT_NEAR(told[i], sum[i], 0.04f);
        }
}

TEST(CoatTint, OfNoWeightLeavesTheBase) {
    const Bsdf b = make_coated_total(table(), {0.7f, 0.5f, 0.2f}, 0.3f, 0.3f, tint(Rgb(1), 0));
    const Vec3 wo = at_cos(0.2f), wi = at_cos(0.6f);
    const Rgb f = eval(b, wo, wi);
    EXPECT_NEAR(f.r, 0.7f * kInvPi * 0.6f, 1e-6f);
    EXPECT_NEAR(f.b, 0.2f * kInvPi * 0.6f, 1e-6f);
}

TEST(CoatTint, ThatReflectsEverythingLeavesNoBase) {
    for (const float alpha : {0.0f, 0.4f}) {
        const Bsdf b = make_coated_total(table(), Rgb(1), alpha, alpha, tint(Rgb(1)));
        const Rgb all = albedo(b, at_cos(0.6f));
        EXPECT_NEAR(all.g, 1, 0.01f) << alpha;
        const Rgb f = eval(b, at_cos(0.6f), at_cos(0.1f));
        EXPECT_TRUE(is_finite(f) && f.r >= 0) << alpha;
    }
}

}  // namespace
}  // namespace covtrace
