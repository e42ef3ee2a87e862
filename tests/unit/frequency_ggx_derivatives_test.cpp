// The closed forms are the derivatives of the functions that the path tracer evaluates.
#include "frequency/ggx_derivatives.h"

#include <gtest/gtest.h>

#include "bsdf/lobe_function.h"
#include "core/rng.h"
#include "core/warp.h"

namespace covtrace {
namespace {

namespace cov = covariance;

void expect_same(const cov::Jet<double>& a, const cov::Jet<double>& b) {
    const double tolerance = 1e-9 * (1 + std::abs(b.uu) + std::abs(b.vv) + b.u * b.u + b.v * b.v);
    EXPECT_NEAR(a.u, b.u, tolerance);
    EXPECT_NEAR(a.v, b.v, tolerance);
    EXPECT_NEAR(a.uu, b.uu, tolerance);
    EXPECT_NEAR(a.uv, b.uv, tolerance);
    EXPECT_NEAR(a.vv, b.vv, tolerance);
}

/// Glossy reflections by a border of glass, of metal, and by one without Fresnel's factor.
LobeShare lobe_of(int i, Rng& rng) {
    LobeShare lobe;
    lobe.kind = LobeKind::glossy_reflection;
    lobe.alpha_x = 0.02f + rng.next_float();
    lobe.alpha_y = 0.02f + rng.next_float();
    if (i % 3 == 0) return lobe;
    lobe.border_eta = i % 3 == 1 ? 1.5f : 0.3f;
    lobe.border_k = i % 3 == 1 ? 0.0f : 3.5f;
    return lobe;
}

LocalAxes axes_along(Vec3 direction) {
    // The axes are of unit length in double, as the closed forms take for granted.
    const auto f = cov::frame_along<double>(cov::normalized_or<double>(direction, {}));
    return {f.x, f.y, f.z};
}

cov::JetVec3<double> jet(const LocalAxes& a) {
    return cov::jet_direction<double>(a.x, a.y, a.z);
}

TEST(GgxDerivatives, OfAReflectionAreThoseOfTheLobesFunction) {
    Rng rng(3);
    int compared = 0;
    for (int i = 0; i < 600; ++i) {
        const LobeShare lobe = lobe_of(i, rng);
        const LocalAxes wo = axes_along(square_to_sphere(rng.next_2d()));
        const LocalAxes wi = axes_along(square_to_sphere(rng.next_2d()));
        const auto f = lobe_function(lobe, jet(wo), wi.z);
        const auto l = log_reflection(lobe, wo, wi.z);
        ASSERT_EQ(l.has_value(), f.value > 0);
        if (!l || std::abs(wo.z.z) < 0.02 || std::abs(wi.z.z) < 0.02) continue;
        expect_same(*l, cov::log_derivatives(f));
        ++compared;
    }
    EXPECT_GT(compared, 200);
}

TEST(GgxDerivatives, OfMaskingAreThoseOfItsFunction) {
    Rng rng(4);
    for (int i = 0; i < 600; ++i) {
        const LobeShare lobe = lobe_of(i, rng);
        const LocalAxes wi = axes_along(square_to_sphere(rng.next_2d()));
        cov::Vec3<double> wo = axes_along(square_to_sphere(rng.next_2d())).z;
        if (std::abs(wo.z) < 0.02 || std::abs(wi.z.z) < 0.02) continue;
        const auto l = log_masked_cosine(lobe, wo, wi);
        wo.z = std::abs(wo.z);
        auto direction = jet(wi);
        direction.z = abs(direction.z);
        const auto f = Ggx{lobe.alpha_x, lobe.alpha_y}.g2_over_cos_o(wo, direction) *
                       cov::jet_solid_angle<double>();
        expect_same(l, cov::log_derivatives(f));
    }
}

}  // namespace
}  // namespace covtrace
