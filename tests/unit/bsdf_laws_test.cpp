/// Laws that hold for every model, at random pairs of directions.
#include <gtest/gtest.h>

#include <string>

#include "bsdf_fixtures.h"
#include "core/rng.h"
#include "core/warp.h"

namespace covtrace {
namespace {

struct Case {
    std::string name;
    Bsdf bsdf;
};
std::ostream& operator<<(std::ostream& out, const Case& c) {
    return out << c.name;
}

std::vector<Case> all_cases() {
    const Rgb copper_eta(0.2f, 0.92f, 1.1f), copper_k(3.9f, 2.45f, 2.14f), tan(0.7f, 0.5f, 0.2f);
    return {
        {"diffuse", DiffuseBsdf{tan}},
        {"black", DiffuseBsdf{}},
        {"transmitting", DiffuseTransmissionBsdf{{0.5f, 0.3f, 0.1f}, {0.1f, 0.4f, 0.2f}}},
        {"only_transmitting", DiffuseTransmissionBsdf{Rgb(0), tan}},
        {"mirror", ConductorBsdf{copper_eta, copper_k}},
        {"copper_smoothest", ConductorBsdf{copper_eta, copper_k, 0.001f, 0.001f}},
        {"copper_rough", ConductorBsdf{copper_eta, copper_k, 0.3f, 0.3f}},
        {"copper_roughest", ConductorBsdf{copper_eta, copper_k, 1, 1}},
        {"copper_brushed", ConductorBsdf{copper_eta, copper_k, 0.05f, 0.4f}},
        {"copper_thread", ConductorBsdf{copper_eta, copper_k, 1e-4f, 0.5f}},
        {"tinted_mirror", schlick_metal(0, 0)},
        {"tinted_metal", schlick_metal(0.2f, 0.2f)},
        {"tinted_metal_brushed", schlick_metal(0.05f, 0.4f)},
        {"tinted_metal_bouncing", with_multiple_scattering(schlick_metal(0.6f, 0.6f), white())},
        {"filmed_metal", filmed_metal(0.2f, 0.4f)},
        {"filmed_metal_bouncing", with_multiple_scattering(filmed_metal(0.6f, 0.6f), white())},
        {"copper_bouncing", bouncing_copper(0.6f, 0.6f)},
        {"copper_bouncing_brushed", bouncing_copper(0.2f, 0.4f)},
        {"frosted_bouncing", bouncing_glass(0.4f)},
        {"glass", DielectricBsdf{1.5f}},
        {"no_border", DielectricBsdf{1, 0.3f, 0.3f}},
        {"frosted", DielectricBsdf{1.5f, 0.2f, 0.2f}},
        {"frosted_fine", DielectricBsdf{1.5f, 0.01f, 0.01f}},
        {"frosted_brushed", DielectricBsdf{1.33f, 0.1f, 0.6f}},
        {"filmed_frosted",
         DielectricBsdf{.alpha_x = 0.2f, .alpha_y = 0.2f, .film = {0.9f, 1.8f, 350}}},
        {"filmed_frosted_bouncing", bouncing_filmed_glass(0.6f)},
        {"bubble", DielectricBsdf{1 / 1.5f, 0.4f, 0.4f}},
        {"nearly_matched", DielectricBsdf{1.001f, 0.3f, 0.3f}},
        {"varnish", make_coated_diffuse(coat(), reflectance_powers(tan), 0, 0, 5)},
        {"satin", make_coated_diffuse(coat(), reflectance_powers(tan), 0.1f, 0.1f, 5)},
        {"matt", make_coated_diffuse(coat(), reflectance_powers(tan), 0.7f, 0.7f, 5)},
        {"brushed_coat", make_coated_diffuse(coat(), reflectance_powers(tan), 0.1f, 0.5f, 5)},
        {"coat_on_black", make_coated_diffuse(coat(), reflectance_powers(Rgb(0)), 0.1f, 0.1f, 5)},
        {"tinted_varnish", make_coated_total(coat(), tan, 0, 0, tint())},
        {"tinted_satin", make_coated_total(coat(), tan, 0.1f, 0.1f, tint())},
        {"tinted_brushed", make_coated_total(coat(), tan, 0.1f, 0.5f, tint())},
        {"filmed_varnish", make_coated_total(coat(), tan, 0, 0, filmed())},
        {"filmed_brushed", make_coated_total(coat(), tan, 0.1f, 0.5f, filmed())},
        {"satin_bouncing", bouncing_satin(0.4f, 0.4f)},
        {"satin_bouncing_brushed", bouncing_satin(0.1f, 0.5f)},
        {"lacquer_on_mirror", coated_metal(0, 0, 0, 0)},
        {"lacquer_on_copper", coated_metal(0, 0, 0.2f, 0.2f)},
        {"frost_on_mirror", coated_metal(0.2f, 0.2f, 0, 0)},
        {"frost_on_copper", coated_metal(0.1f, 0.3f, 0.05f, 0.4f)},
        {"haze_on_tan", hazy_diffuse(0)},
        {"frosted_haze_on_tan", hazy_diffuse(0.3f)},
        {"banded_haze_on_tan", banded_haze(0.3f)},
        {"haze_on_mirror", hazy_metal(0, 0)},
        {"haze_on_copper", hazy_metal(0, 0.2f)},
        {"frosted_haze_on_mirror", hazy_metal(0.2f, 0)},
        {"frosted_haze_on_copper", hazy_metal(0.3f, 0.2f)},
        {"pane", ThinDielectricBsdf{1.5f}},
        {"pane_brushed", ThinDielectricBsdf{1.5f, Rgb(0.9f), 0.05f, 0.4f}},
        {"pane_bouncing",
         with_multiple_scattering(ThinDielectricBsdf{1.5f, Rgb(0.9f), 0.6f, 0.6f}, white())},
        {"filmed_pane", filmed_pane(0)},
        {"filmed_rough_pane", filmed_pane(0.3f)},
        {"interface", InterfaceBsdf{}},
        {"unlit", UnlitBsdf{tan, true}},
        {"wax", wax(0, 0, false)},
        {"rough_wax", wax(0.2f, 0.4f, false)},
        {"matched_wax", wax(0.2f, 0.2f, false, false)},
        {"wax_left", wax(0, 0, true)},
        {"rough_wax_left", wax(0.2f, 0.4f, true)},
        {"matched_wax_left", wax(0.2f, 0.2f, true, false)},
        {"hair", hair(0.3f, 0.3f, 0.4f)},
        {"hair_white", hair(0.8f, 0.6f, -0.9f, Rgb(0))},
        {"hair_narrow", hair(0.05f, 0.1f, 0)},
        {"hair_at_its_edge", hair(1, 1, 1)},
        {"velvet", LayeredBsdf{DiffuseBsdf{tan}, sheen(0.3f), {}}},
        {"velvet_on_satin",
         LayeredBsdf{make_coated_total(coat(), tan, 0.1f, 0.5f), sheen(0.05f), {}}},
        {"velvet_on_pane", LayeredBsdf{ThinDielectricBsdf{1.5f, Rgb(0.9f)}, sheen(1), {}}},
        {"velvet_on_rough_pane", LayeredBsdf{filmed_pane(0.3f), sheen(0.3f), {}}},
        {"lacquer_over_rough_pane",
         LayeredBsdf{ThinDielectricBsdf{1.5f, Rgb(0.9f), 0.3f, 0.1f}, {}, lacquer(0.1f)}},
        {"clear_on_mirror", LayeredBsdf{ConductorBsdf{copper_eta, copper_k}, {}, clear(0)}},
        {"clear_on_copper",
         LayeredBsdf{ConductorBsdf{copper_eta, copper_k, 0.3f, 0.3f}, {}, clear(0.04f)}},
        {"clear_on_bouncing_copper", LayeredBsdf{bouncing_copper(0.5f, 0.5f), {}, clear(0.04f)}},
        {"lacquer_over_tan", LayeredBsdf{DiffuseBsdf{tan}, {}, lacquer(0)}},
        {"lacquer_over_copper", LayeredBsdf{bouncing_copper(0.5f, 0.5f), {}, lacquer(0.2f)}},
        {"lacquer_over_frost", LayeredBsdf{DielectricBsdf{1.5f, 0.2f, 0.2f}, {}, lacquer(0.1f)}},
        {"tilted_lacquer_on_velvet", LayeredBsdf{make_coated_total(coat(), tan, 0.2f, 0.2f),
                                                 sheen(0.2f), lacquer(0.5f, {0.2f, 0.1f, 1})}},
        {"clear_on_tan", LayeredBsdf{DiffuseBsdf{tan}, {}, clear(0)}},
        {"tilted_clear_on_tan", LayeredBsdf{DiffuseBsdf{tan}, {}, clear(0.2f, {0.4f, -0.3f, 1})}},
        {"tilted_clear_on_velvet", LayeredBsdf{make_coated_total(coat(), tan, 0.2f, 0.2f),
                                               sheen(0.2f), clear(0.09f, {0.2f, 0.1f, 1})}},
    };
}

class BsdfLaws : public testing::TestWithParam<Case> {
  protected:
    const Bsdf& bsdf = GetParam().bsdf;
};
INSTANTIATE_TEST_SUITE_P(Models, BsdfLaws, testing::ValuesIn(all_cases()),
                         [](const auto& c) { return c.param.name; });

bool is_valid(Rgb c) {
    return is_finite(c) && c.r >= 0 && c.g >= 0 && c.b >= 0;
}

void expect_near(Rgb a, Rgb b, float relative, const char* what) {
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(a[i], b[i], relative * std::max(std::abs(a[i]), std::abs(b[i])) + 3e-6f)
            << what;
}

/// The index on the side of w.
float index_at(const Bsdf& bsdf, Vec3 w) {
    if (const auto* layered = std::get_if<LayeredBsdf>(&bsdf))
        return index_at(base_of(*layered), w);
    const auto* dielectric = std::get_if<DielectricBsdf>(&bsdf);
    return dielectric && w.z < 0 ? dielectric->eta : 1;
}

/// Whether a model has the gain of multiple scattering, which is not reciprocal.
bool has_gain(const Bsdf& bsdf) {
    const auto* metal = std::get_if<ConductorBsdf>(&bsdf);
    const auto* glass = std::get_if<DielectricBsdf>(&bsdf);
    const auto* coated = std::get_if<CoatedDiffuseBsdf>(&bsdf);
    const auto* pane = std::get_if<ThinDielectricBsdf>(&bsdf);
    return (metal && metal->white) || (glass && glass->from_outside) || (coated && coated->white) ||
           (pane && pane->white);
}

TEST_P(BsdfLaws, Reciprocity) {
    if (has_gain(bsdf)) return;
    // The scales of hair lean to one side, and its shares hang on wo alone.
    if (std::holds_alternative<HairBsdf>(bsdf)) return;
    // Light that leaves a body came from anywhere below: its other direction does not count.
    if (const auto* body = std::get_if<SubsurfaceBsdf>(&bsdf); body && body->is_left) return;
    // A clear coat dims the surface below for the direction of view alone, as glTF has it.
    if (const auto* layered = std::get_if<LayeredBsdf>(&bsdf); layered && layered->coat.weight > 0)
        return;
    Rng rng(11);
    for (int i = 0; i < 4000; ++i) {
        const Vec3 wo = square_to_sphere(rng.next_2d());
        // Sampled pairs reach narrow lobes, others the rest.
        Vec3 wi = square_to_sphere(rng.next_2d());
        if (i % 2) {
            const auto s = sample(bsdf, wo, rng.next_float(), rng.next_2d());
            if (!s || is_specular(s->lobe)) continue;
            wi = s->wi;
        }
        if (std::abs(wo.z) < 0.01f || std::abs(wi.z) < 0.01f) continue;
        const Rgb there = eval(bsdf, wo, wi) / std::abs(wi.z) / sqr(index_at(bsdf, wo));
        const Rgb back = eval(bsdf, wi, wo) / std::abs(wo.z) / sqr(index_at(bsdf, wi));
        // Half vectors of almost straight transmission cancel: alphas of 1e-4 and matched indices
        // feel the rounding.
        const bool ill_conditioned = GetParam().name == "copper_thread" ||
                                     GetParam().name == "copper_smoothest" ||
                                     GetParam().name == "nearly_matched";
        expect_near(there, back, ill_conditioned ? 0.05f : 1e-3f, "f(wo, wi) against f(wi, wo)");
    }
}

TEST_P(BsdfLaws, SampleAgreesWithEvalAndPdf) {
    Rng rng(12);
    int sampled = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec3 wo = square_to_sphere(rng.next_2d());
        const auto s = sample(bsdf, wo, rng.next_float(), rng.next_2d());
        if (!s) continue;
        ASSERT_NEAR(length(s->wi), 1, 1e-4f);
        ASSERT_GT(s->pdf, 0);
        ASSERT_TRUE(is_valid(s->weight));
        EXPECT_EQ(is_transmission(s->lobe), wo.z * s->wi.z < 0);
        if (is_specular(s->lobe)) continue;
        if (std::abs(wo.z) < 1e-3f || std::abs(s->wi.z) < 1e-3f) continue;
        ++sampled;
        const bool ill_conditioned = GetParam().name == "copper_thread" ||
                                     GetParam().name == "copper_smoothest" ||
                                     GetParam().name == "nearly_matched";
        const float tolerance = ill_conditioned ? 0.1f : 4e-3f;
        EXPECT_NEAR(pdf(bsdf, wo, s->wi) / s->pdf, 1, tolerance) << wo.z << " -> " << s->wi.z;
        // The weight of a walk is tested in tests/statistical/bsdf_coated_conductor_test.cpp.
        if (!std::holds_alternative<CoatedConductorBsdf>(bsdf) &&
            !std::holds_alternative<HazyDiffuseBsdf>(bsdf))
            expect_near(s->weight, eval(bsdf, wo, s->wi) / pdf(bsdf, wo, s->wi),
                        ill_conditioned ? 0.02f : 1e-3f, "weight");
        EXPECT_FLOAT_EQ(s->eta, index_at(bsdf, s->wi) / index_at(bsdf, wo));
    }
    if (is_specular(bsdf) || GetParam().name == "black")
        EXPECT_EQ(sampled, 0);
    else
        // Most samples of bodies enter, which counts as specular
        EXPECT_GT(sampled, std::holds_alternative<SubsurfaceBsdf>(bsdf) ? 300 : 1000);
}

TEST_P(BsdfLaws, LobesSumToEval) {
    Rng rng(13);
    for (int i = 0; i < 4000; ++i) {
        const Vec3 wo = square_to_sphere(rng.next_2d());
        Vec3 wi = square_to_sphere(rng.next_2d());
        if (i % 2) {
            const auto s = sample(bsdf, wo, rng.next_float(), rng.next_2d());
            if (s && !is_specular(s->lobe)) wi = s->wi;
        }
        const LobeShares shares = lobe_shares(bsdf, wo, wi, eval(bsdf, wo, wi));
        Rgb sum;
        for (int j = 0; j < shares.count; ++j) {
            sum += shares.lobes[static_cast<size_t>(j)].value;
            EXPECT_EQ(is_transmission(shares.lobes[static_cast<size_t>(j)].kind), wo.z * wi.z < 0);
            EXPECT_FALSE(is_specular(shares.lobes[static_cast<size_t>(j)].kind));
        }
        expect_near(sum, eval(bsdf, wo, wi), 1e-5f, "sum of the lobes");
    }
}

TEST_P(BsdfLaws, GivesOutNoMoreEnergyThanArrives) {
    // Bodies are in furnaces whole, in tests/render/subsurface_test.cpp: their border's samples
    // have weights of both sides of 1.
    if (std::holds_alternative<SubsurfaceBsdf>(bsdf)) return;
    Rng rng(14);
    for (float cos_o : {1.0f, 0.7f, 0.3f, 0.05f, -0.05f, -0.4f, -1.0f}) {
        const Vec3 wo{std::sqrt(1 - cos_o * cos_o), 0, cos_o};
        constexpr int kSide = 60;
        constexpr float kGolden = 0.61803399f;  // spreads numbers evenly
        double sum[3] = {0, 0, 0};
        for (int i = 0; i < kSide * kSide; ++i) {
            const Vec2 u{(static_cast<float>(i % kSide) + rng.next_float()) / kSide,
                         (static_cast<float>(i / kSide) + rng.next_float()) / kSide};
            // The choice is spread evenly, as both of it have weights where borders have colours.
            const float turn = static_cast<float>(i) * kGolden;
            const auto s = sample(bsdf, wo, turn - std::floor(turn), u);
            if (!s) continue;
            // The radiance factor of transmission is undone, so that this is energy.
            for (int c = 0; c < 3; ++c) sum[c] += s->weight[c] * sqr(s->eta);
        }
        for (double c : sum) EXPECT_LE(c / (kSide * kSide), 1.002) << "cos " << cos_o;
    }
}

TEST_P(BsdfLaws, DegenerateDirectionsGiveNoEnergyAndNoNan) {
    Rng rng(15);
    const float grazing[] = {0.0f, -0.0f, 1e-38f, 1e-20f, -1e-10f, 1e-6f, -1e-4f, 1.0f, -1.0f};
    auto with_z = [&](float z) {
        const float phi = 2 * kPi * rng.next_float(), r = safe_sqrt(1 - z * z);
        return Vec3{r * std::cos(phi), r * std::sin(phi), z};
    };
    const float corners[] = {0.0f, 0.5f, 1 - 0x1p-24f};
    for (float zo : grazing) {
        for (float zi : grazing) {
            for (int i = 0; i < 20; ++i) {
                const Vec3 wo = with_z(zo);
                // Half vectors vanish for the opposite and the mirror direction.
                const Vec3 wi = i == 0 ? -wo : i == 1 ? Vec3{-wo.x, -wo.y, wo.z} : with_z(zi);
                const Rgb f = eval(bsdf, wo, wi);
                const float p = pdf(bsdf, wo, wi);
                EXPECT_TRUE(is_valid(f)) << zo << " " << zi;
                EXPECT_TRUE(std::isfinite(p) && p >= 0) << zo << " " << zi;
                EXPECT_TRUE(is_valid(albedo(bsdf, wo)));
                if (wo.z == 0 || wi.z == 0) {
                    EXPECT_TRUE(is_black(f));
                    EXPECT_EQ(p, 0);
                    EXPECT_TRUE(is_black(eval(bsdf, wi, wo)));
                }
            }
        }
        for (float a : corners)
            for (float b : corners)
                for (float lobe : corners) {
                    const auto s = sample(bsdf, with_z(zo), lobe, {a, b});
                    if (zo == 0) {
                        EXPECT_FALSE(s);
                    }
                    if (!s) continue;
                    EXPECT_TRUE(is_valid(s->weight)) << zo << " " << a << " " << b;
                    EXPECT_TRUE(std::isfinite(s->pdf) && s->pdf > 0) << zo << " " << a << " " << b;
                    EXPECT_NEAR(length(s->wi), 1, 1e-4f);
                    EXPECT_NE(s->wi.z, 0);
                }
    }
}

TEST(BsdfSpecular, ModelsWithoutOtherLobesNeverEvaluate) {
    int models = 0;
    for (const Case& c : all_cases()) {
        if (!is_specular(c.bsdf)) continue;
        ++models;
        Rng rng(16);
        for (int i = 0; i < 1000; ++i) {
            const Vec3 wo = square_to_sphere(rng.next_2d()), wi = square_to_sphere(rng.next_2d());
            EXPECT_TRUE(is_black(eval(c.bsdf, wo, wi))) << c.name;
            EXPECT_EQ(pdf(c.bsdf, wo, wi), 0) << c.name;
            EXPECT_EQ(lobe_shares(c.bsdf, wo, wi, Rgb(0)).count, 0) << c.name;
            const auto s = sample(c.bsdf, wo, rng.next_float(), rng.next_2d());
            ASSERT_TRUE(s) << c.name;
            EXPECT_TRUE(is_specular(s->lobe)) << c.name;
        }
    }
    // The models are mirror, tinted_mirror, glass, no_border, lacquer_on_mirror, pane, filmed_pane,
    // interface, unlit, wax and clear_on_mirror.
    EXPECT_EQ(models, 11);
}

}  // namespace
}  // namespace covtrace
