// The function that the analysis differentiates is the one that the path tracer evaluates, for the
// lobes of every BSDF; and its exact derivatives are those of finite differences.
#include <gtest/gtest.h>

#include <cmath>

#include "bsdf/coat_table.h"
#include "bsdf/lobe_function.h"
#include "bsdf/sheen.h"
#include "core/rng.h"
#include "core/warp.h"
#include "covariance/covariance.hpp"

namespace covtrace {
namespace {

namespace cov = covariance;

const CoatTable& coat_table() {
    static const CoatTable table(1.5f, 0);
    return table;
}

struct Model {
    const char* name;
    Bsdf bsdf;
};

/// Models without total reflection by the coat's table and with grey conductors, for which the
/// function is exact.
std::vector<Model> models() {
    static const SheenTable fibres;
    ConductorBsdf tinted{Rgb(1), Rgb(0), 0.3f, 0.3f};
    tinted.schlick = metal_of_edge(Rgb(0.6f), Rgb(0.3f));
    return {{"metal by its colours", tinted},
            {"lacquer", LayeredBsdf{DiffuseBsdf{}, {}, {1, 0.3f, {0, 0, 1}, &coat_table()}}},
            {"velvet", LayeredBsdf{DiffuseBsdf{}, {Rgb(1), 0.2f, &fibres}, {}}},
            {"diffuse", DiffuseBsdf{Rgb(0.5f)}},
            {"diffuse transmission", DiffuseTransmissionBsdf{Rgb(0.5f), Rgb(0.3f)}},
            {"conductor", ConductorBsdf{Rgb(0.2f), Rgb(3.0f), 0.2f, 0.2f}},
            {"brushed conductor", ConductorBsdf{Rgb(1.2f), Rgb(7.0f), 0.05f, 0.4f}},
            {"dielectric", DielectricBsdf{1.5f, 0.3f, 0.3f}},
            {"brushed dielectric", DielectricBsdf{1.3f, 0.1f, 0.5f}},
            {"rough pane", ThinDielectricBsdf{1.5f, Rgb(1), 0.3f, 0.3f}},
            {"brushed pane", ThinDielectricBsdf{1.4f, Rgb(1), 0.1f, 0.4f}},
            {"coat",
             make_coated_diffuse(coat_table(), reflectance_powers(Rgb(0.4f)), 0.3f, 0.15f, 10)}};
}

/// A vector of doubles, to difference in.
struct Double3 {
    double x = 0, y = 0, z = 0;
    friend Double3 operator+(Double3 a, Double3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Double3 operator*(double s, Double3 a) { return {s * a.x, s * a.y, s * a.z}; }
    friend double dot(Double3 a, Double3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
};

TEST(LobeFunction, IsProportionalToWhatThePathTracerEvaluates) {
    for (const Model& model : models()) {
        SCOPED_TRACE(model.name);
        Rng rng(21);
        double first[7] = {};
        int compared = 0;
        for (int i = 0; i < 4000; ++i) {
            const Vec3 wo = square_to_sphere(rng.next_2d());
            const auto s = sample(model.bsdf, wo, rng.next_float(), rng.next_2d());
            if (!s || std::abs(wo.z) < 0.05f || std::abs(s->wi.z) < 0.05f) continue;
            const LobeShares shares =
                lobe_shares(model.bsdf, wo, s->wi, eval(model.bsdf, wo, s->wi));
            for (int j = 0; j < shares.count; ++j) {
                const LobeShare& lobe = shares.lobes[size_t(j)];
                const bool base = lobe.kind == LobeKind::diffuse_reflection && lobe.border_eta > 0;
                if (base || !(luminance(lobe.value) > 1e-4f)) continue;
                // The BTDF's scale depends on the side through its index.
                double& scale = first[size_t(lobe.kind)];
                const double ratio = double(luminance(lobe.value)) / lobe_function(lobe, wo, s->wi);
                if (scale == 0) scale = ratio;
                EXPECT_NEAR(ratio / scale, 1, 5e-3) << int(lobe.kind) << ' ' << wo.z;
                ++compared;
            }
        }
        EXPECT_GT(compared, 1000);
    }
}

TEST(LobeFunction, BaseBelowASmoothCoatIsSeenThroughItTwice) {
    const Bsdf coat = make_coated_diffuse(coat_table(), reflectance_powers(Rgb(0.4f)), 0, 0, 10);
    double first = 0;
    for (const float z : {0.9f, 0.5f, 0.3f}) {
        const Vec3 wo{std::sqrt(1 - z * z), 0, z}, wi{0.6f, 0, 0.8f};
        const LobeShares shares = lobe_shares(coat, wo, wi, eval(coat, wo, wi));
        ASSERT_EQ(shares.count, 1);
        const double ratio =
            double(luminance(shares.lobes[0].value)) / lobe_function(shares.lobes[0], wo, wi);
        if (first == 0) first = ratio;
        EXPECT_NEAR(ratio / first, 1, 1e-4) << z;
    }
}

TEST(LobeFunction, DerivativesAreThoseOfFiniteDifferences) {
    for (const Model& model : models()) {
        SCOPED_TRACE(model.name);
        Rng rng(22);
        int compared = 0;
        for (int i = 0; i < 400; ++i) {
            const Vec3 wo = square_to_sphere(rng.next_2d());
            const auto s = sample(model.bsdf, wo, rng.next_float(), rng.next_2d());
            if (!s || std::abs(wo.z) < 0.2f || std::abs(s->wi.z) < 0.2f) continue;
            const LobeShares shares =
                lobe_shares(model.bsdf, wo, s->wi, eval(model.bsdf, wo, s->wi));
            for (int j = 0; j < shares.count; ++j) {
                const LobeShare& lobe = shares.lobes[size_t(j)];
                const auto f = cov::frame_along<double>(cov::Vec3<double>(wo));
                const cov::Vec3<double> wi(s->wi);
                const auto jet = lobe_function(lobe, cov::jet_direction<double>(f.x, f.y, f.z),
                                               cov::jet_constant<double>(wi));
                if (!(jet.value > 1e-6)) continue;
                // The function has no derivatives where total reflection begins.
                if (lobe.border_eta > 0 && lobe.border_eta < 1 && lobe.border_k == 0) {
                    const Vec3 h = wo + s->wi * (is_transmission(lobe.kind) ? lobe.eta : 1.0f);
                    const float c = dot(wo, normalize(h));
                    if (1 - c * c > 0.95f * sqr(lobe.border_eta)) continue;
                }
                const auto value = [&](double u, double v) {
                    const auto w = cov::normalized_or(f.z + u * f.x + v * f.y, f.z);
                    return std::log(
                        lobe_function(lobe, Double3{w.x, w.y, w.z}, Double3{wi.x, wi.y, wi.z}));
                };
                const double h = 1e-4, size = -1 / (cov::four_pi_sq<double> * h * h);
                const cov::Sym2<double> c = cov::log_curvature(jet);
                const double tolerance = 1e-3 * (1 + std::abs(c.xx) + std::abs(c.yy));
                EXPECT_NEAR(c.xx, size * (value(h, 0) - 2 * value(0, 0) + value(-h, 0)), tolerance);
                EXPECT_NEAR(c.yy, size * (value(0, h) - 2 * value(0, 0) + value(0, -h)), tolerance);
                EXPECT_NEAR(c.xy,
                            size / 4 * (value(h, h) - value(h, -h) - value(-h, h) + value(-h, -h)),
                            tolerance);
                ++compared;
            }
        }
        EXPECT_GT(compared, 100);
    }
}

}  // namespace
}  // namespace covtrace
