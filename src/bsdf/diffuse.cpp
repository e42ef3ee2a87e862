/// The Lambertian BSDF.
#include "bsdf/models.h"
#include "core/warp.h"

namespace covtrace {

Vec3 sample_cosine(Vec3 wo, bool transmit, Vec2 u) {
    const Vec3 wi = square_to_cosine_hemisphere(u);
    return (wo.z < 0) == transmit ? wi : mirror_z(wi);
}

Rgb eval(const DiffuseBsdf& b, Vec3 wo, Vec3 wi) {
    return same_side(wo, wi) ? b.reflectance * (kInvPi * std::abs(wi.z)) : Rgb{};
}

float pdf(const DiffuseBsdf&, Vec3 wo, Vec3 wi) {
    return same_side(wo, wi) ? cosine_hemisphere_pdf(std::abs(wi.z)) : 0;
}

std::optional<BsdfSample> sample(const DiffuseBsdf& b, Vec3 wo, float, Vec2 u) {
    if (is_black(b.reflectance)) return {};
    const Vec3 wi = sample_cosine(wo, false, u);
    if (!same_side(wo, wi)) return {};
    return BsdfSample{wi, b.reflectance, cosine_hemisphere_pdf(std::abs(wi.z)),
                      LobeKind::diffuse_reflection};
}

LobeShares lobe_shares(const DiffuseBsdf&, Vec3 wo, Vec3 wi, Rgb value) {
    if (!same_side(wo, wi)) return {};
    return {{LobeShare{LobeKind::diffuse_reflection, value}}, 1};
}

}  // namespace covtrace
