#include "bsdf/ggx.h"

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/warp.h"

namespace covtrace {
namespace {

Vec3 direction(float theta, float phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// Integral over the upper hemisphere by the midpoint rule.
template <typename Function>
double integrate_hemisphere(Function f, int n = 600) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double theta = (i + 0.5) * M_PI / 2 / n;
        for (int j = 0; j < n; ++j)
            sum += std::sin(theta) * f(direction(static_cast<float>(theta),
                                                 static_cast<float>((j + 0.5) * 2 * M_PI / n)));
    }
    return sum * (M_PI / 2 / n) * (2 * M_PI / n);
}

struct Widths {
    float x, y;
};
class GgxOfWidths : public testing::TestWithParam<Widths> {
  protected:
    Ggx ggx{GetParam().x, GetParam().y};
};
INSTANTIATE_TEST_SUITE_P(Widths, GgxOfWidths,
                         testing::Values(Widths{0.1f, 0.1f}, Widths{0.5f, 0.5f}, Widths{1, 1},
                                         Widths{0.1f, 0.4f}, Widths{0.8f, 0.2f}));

TEST_P(GgxOfWidths, ProjectedAreaOfTheNormalsIsOne) {
    EXPECT_NEAR(integrate_hemisphere([&](Vec3 m) { return ggx.d(m) * m.z; }), 1, 2e-3);
}

// The area that is visible from w projects to the area of the plain surface, which pins masking to
// the distribution.
TEST_P(GgxOfWidths, VisibleAreaIsTheCosine) {
    for (float theta : {0.0f, 0.7f, 1.3f, 1.5f}) {
        const Vec3 w = direction(theta, 0.9f);
        const double area = integrate_hemisphere(
            [&](Vec3 m) { return ggx.g1(w) * std::max(0.0f, dot(w, m)) * ggx.d(m); });
        EXPECT_NEAR(area / w.z, 1, 3e-3) << "theta " << theta;
        EXPECT_NEAR(integrate_hemisphere([&](Vec3 m) { return ggx.visible_normal_pdf(w, m); }), 1,
                    3e-3);
    }
}

TEST_P(GgxOfWidths, MaskingFormsAgree) {
    Rng rng(1);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 a = square_to_cosine_hemisphere(rng.next_2d());
        const Vec3 b = square_to_cosine_hemisphere(rng.next_2d());
        if (a.z < 1e-3f || b.z < 1e-3f) continue;
        const float lambda_a = 1 / ggx.g1(a) - 1, lambda_b = 1 / ggx.g1(b) - 1;
        const float g2 = 1 / (1 + lambda_a + lambda_b);
        EXPECT_NEAR(ggx.g2_over_cos_o(a, b) * a.z, g2, 1e-5f);
        EXPECT_NEAR(ggx.g2_over_g1(a, b), g2 / ggx.g1(a), 1e-5f * g2 / ggx.g1(a));
        EXPECT_LE(g2, std::min(ggx.g1(a), ggx.g1(b)) * 1.00001f);
    }
}

TEST_P(GgxOfWidths, SampledNormalsAreUnitUpwardAndVisible) {
    Rng rng(2);
    for (int i = 0; i < 20000; ++i) {
        Vec3 w = square_to_cosine_hemisphere(rng.next_2d());
        if (i % 3 == 0) w = normalize({w.x, w.y, 1e-6f + w.z * 1e-4f});
        Vec2 u = rng.next_2d();
        if (i % 7 == 0) u.y = 0;
        if (i % 7 == 1) u.y = 1 - 0x1p-24f;
        const Vec3 m = ggx.sample_visible_normal(w, u);
        ASSERT_NEAR(length(m), 1, 1e-5f);
        ASSERT_GT(m.z, 0);
        // The last step of u.y turns the cap's rim to the back of w, where only rounding is left.
        ASSERT_GT(dot(w, m), i % 7 == 1 ? -2e-3f : -1e-6f);
    }
}

}  // namespace
}  // namespace covtrace
