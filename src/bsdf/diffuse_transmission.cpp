/// Lambertian reflection and Lambertian transmission, chosen in proportion to their largest
/// components.
#include "bsdf/models.h"
#include "core/warp.h"

namespace covtrace {
namespace {

/// Probability of choosing reflection; below 0 where there is nothing to choose.
float reflection_probability(const DiffuseTransmissionBsdf& b) {
    const float r = max_component(b.reflectance), t = max_component(b.transmittance);
    return r + t > 0 ? r / (r + t) : -1;
}

}  // namespace

Rgb eval(const DiffuseTransmissionBsdf& b, Vec3 wo, Vec3 wi) {
    if (wo.z == 0) return {};
    return (same_side(wo, wi) ? b.reflectance : b.transmittance) * (kInvPi * std::abs(wi.z));
}

float pdf(const DiffuseTransmissionBsdf& b, Vec3 wo, Vec3 wi) {
    const float reflect = reflection_probability(b);
    if (reflect < 0 || wo.z == 0) return 0;
    return (same_side(wo, wi) ? reflect : 1 - reflect) * cosine_hemisphere_pdf(std::abs(wi.z));
}

std::optional<BsdfSample> sample(const DiffuseTransmissionBsdf& b, Vec3 wo, float u_lobe, Vec2 u) {
    const float reflect = reflection_probability(b);
    if (reflect < 0) return {};
    const bool transmit = u_lobe >= reflect;
    const float probability = transmit ? 1 - reflect : reflect;
    const Vec3 wi = sample_cosine(wo, transmit, u);
    if (wi.z == 0) return {};
    return BsdfSample{wi, (transmit ? b.transmittance : b.reflectance) / probability,
                      probability * cosine_hemisphere_pdf(std::abs(wi.z)),
                      transmit ? LobeKind::diffuse_transmission : LobeKind::diffuse_reflection};
}

LobeShares lobe_shares(const DiffuseTransmissionBsdf&, Vec3 wo, Vec3 wi, Rgb value) {
    const LobeKind kind =
        same_side(wo, wi) ? LobeKind::diffuse_reflection : LobeKind::diffuse_transmission;
    return {{LobeShare{kind, value}}, 1};
}

}  // namespace covtrace
