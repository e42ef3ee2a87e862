#include "bsdf/bsdf.h"

#include <cmath>

#include "bsdf/fresnel.h"
#include "bsdf/measured_brdf.h"
#include "bsdf/models.h"

namespace covtrace {
namespace {

Rgb eval(const InterfaceBsdf&, Vec3, Vec3) {
    return {};
}
float pdf(const InterfaceBsdf&, Vec3, Vec3) {
    return 0;
}
LobeShares lobe_shares(const InterfaceBsdf&, Vec3, Vec3, Rgb) {
    return {};
}
Rgb eval(const UnlitBsdf&, Vec3, Vec3) {
    return {};
}
float pdf(const UnlitBsdf&, Vec3, Vec3) {
    return 0;
}
LobeShares lobe_shares(const UnlitBsdf&, Vec3, Vec3, Rgb) {
    return {};
}

/// Value and density of models whose two computations share nothing.
template <typename Model>
BsdfValue eval_and_pdf(const Model& b, Vec3 wo, Vec3 wi) {
    return {eval(b, wo, wi), pdf(b, wo, wi)};
}

bool is_specular(const DiffuseBsdf&) {
    return false;
}
bool is_specular(const DiffuseTransmissionBsdf&) {
    return false;
}
bool is_specular(const CoatedDiffuseBsdf&) {
    return false;
}
bool is_specular(const HazyDiffuseBsdf&) {
    return false;
}
bool is_specular(const MeasuredBsdf&) {
    return false;
}
bool is_specular(const HairBsdf&) {
    return false;
}
bool is_specular(const InterfaceBsdf&) {
    return true;
}
bool is_specular(const UnlitBsdf&) {
    return true;
}
bool is_specular(const ConductorBsdf& b) {
    return b.alpha_x == 0 && b.alpha_y == 0;
}

Rgb albedo(const DiffuseBsdf& b, Vec3) {
    return b.reflectance;
}
Rgb albedo(const DiffuseTransmissionBsdf& b, Vec3) {
    return b.reflectance + b.transmittance;
}
Rgb albedo(const DielectricBsdf& b, Vec3) {
    return b.transmittance;
}
Rgb albedo(const InterfaceBsdf&, Vec3) {
    return Rgb(1);
}
Rgb albedo(const UnlitBsdf& b, Vec3) {
    return {clamp01(b.colour.r), clamp01(b.colour.g), clamp01(b.colour.b)};
}

}  // namespace

Bsdf base_of(const LayeredBsdf& layered) {
    return std::visit([](const auto& b) { return Bsdf(b); }, layered.base);
}

std::optional<BsdfSample> sample(const InterfaceBsdf&, Vec3 wo, float, Vec2) {
    return BsdfSample{-wo, Rgb(1), 1, LobeKind::specular_transmission};
}

std::optional<BsdfSample> sample(const UnlitBsdf&, Vec3 wo, float, Vec2) {
    return BsdfSample{-wo, Rgb(1), 1, LobeKind::specular_transmission};
}

BsdfValue eval_and_pdf(const Bsdf& bsdf, Vec3 wo, Vec3 wi) {
    return std::visit([&](const auto& b) { return eval_and_pdf(b, wo, wi); }, bsdf);
}

Rgb eval(const Bsdf& bsdf, Vec3 wo, Vec3 wi) {
    return std::visit([&](const auto& b) { return eval(b, wo, wi); }, bsdf);
}

float pdf(const Bsdf& bsdf, Vec3 wo, Vec3 wi) {
    return std::visit([&](const auto& b) { return pdf(b, wo, wi); }, bsdf);
}

std::optional<BsdfSample> sample(const Bsdf& bsdf, Vec3 wo, float u_lobe, Vec2 u) {
    if (wo.z == 0) return {};
    return std::visit([&](const auto& b) { return sample(b, wo, u_lobe, u); }, bsdf);
}

bool is_specular(const Bsdf& bsdf) {
    return std::visit([](const auto& b) { return is_specular(b); }, bsdf);
}

bool has_diffuse_lobe(const Bsdf& bsdf) {
    if (const auto* measured = std::get_if<MeasuredBsdf>(&bsdf)) return measured->brdf->is_wide();
    if (const auto* layered = std::get_if<LayeredBsdf>(&bsdf))
        return !is_black(layered->sheen.colour) || has_diffuse_lobe(base_of(*layered));
    if (const auto* body = std::get_if<SubsurfaceBsdf>(&bsdf)) return body->is_left;
    if (const auto* coated = std::get_if<CoatedConductorBsdf>(&bsdf)) return coated->gap.scatters();
    return std::holds_alternative<DiffuseBsdf>(bsdf) ||
           std::holds_alternative<CoatedDiffuseBsdf>(bsdf) ||
           std::holds_alternative<HazyDiffuseBsdf>(bsdf) ||
           std::holds_alternative<DiffuseTransmissionBsdf>(bsdf);
}

bool has_sharp_lobe(const Bsdf& bsdf) {
    if (const auto* measured = std::get_if<MeasuredBsdf>(&bsdf)) return !measured->brdf->is_wide();
    if (const auto* layered = std::get_if<LayeredBsdf>(&bsdf))
        return layered->coat.weight > 0 || has_sharp_lobe(base_of(*layered));
    if (const auto* body = std::get_if<SubsurfaceBsdf>(&bsdf)) return !body->is_left;
    if (const auto* pane = std::get_if<ThinDielectricBsdf>(&bsdf)) return !is_specular(*pane);
    return std::holds_alternative<ConductorBsdf>(bsdf) ||
           std::holds_alternative<CoatedConductorBsdf>(bsdf) ||
           std::holds_alternative<DielectricBsdf>(bsdf) ||
           std::holds_alternative<CoatedDiffuseBsdf>(bsdf) ||
           std::holds_alternative<HazyDiffuseBsdf>(bsdf);
}

float sharp_lobe_roughness(const Bsdf& bsdf) {
    const auto larger = [](const auto& b) { return std::max(b.alpha_x, b.alpha_y); };
    if (const auto* coated = std::get_if<CoatedConductorBsdf>(&bsdf))
        return std::max(larger(coated->coat), larger(coated->metal));
    if (const auto* hazy = std::get_if<HazyDiffuseBsdf>(&bsdf)) return larger(hazy->coat);
    if (const auto* measured = std::get_if<MeasuredBsdf>(&bsdf); measured && has_sharp_lobe(bsdf))
        return measured->brdf->alpha();
    if (const auto* body = std::get_if<SubsurfaceBsdf>(&bsdf))
        return body->is_left ? std::numeric_limits<float>::infinity() : larger(body->border);
    if (const auto* layered = std::get_if<LayeredBsdf>(&bsdf)) {
        const float base = sharp_lobe_roughness(base_of(*layered));
        if (!(layered->coat.weight > 0)) return base;
        return std::isfinite(base) ? std::max(layered->coat.alpha, base) : layered->coat.alpha;
    }
    return std::visit(
        [&](const auto& b) {
            if constexpr (requires { b.alpha_x; }) return larger(b);
            using Model = std::decay_t<decltype(b)>;
            constexpr bool passes =
                std::is_same_v<Model, InterfaceBsdf> || std::is_same_v<Model, UnlitBsdf>;
            return passes ? 0.0f : std::numeric_limits<float>::infinity();
        },
        bsdf);
}

bool enters_body(const Bsdf& bsdf, const BsdfSample& s) {
    const auto* body = std::get_if<SubsurfaceBsdf>(&bsdf);
    return body && !body->is_left && is_transmission(s.lobe);
}

LobeShares lobe_shares(const Bsdf& bsdf, Vec3 wo, Vec3 wi, Rgb value) {
    return std::visit([&](const auto& b) { return lobe_shares(b, wo, wi, value); }, bsdf);
}

Rgb albedo(const Bsdf& bsdf, Vec3 wo) {
    return std::visit([&](const auto& b) { return albedo(b, wo); }, bsdf);
}

}  // namespace covtrace
