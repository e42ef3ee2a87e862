#include "bsdf/coated_walk.h"

#include <bit>
#include <cmath>

#include "bsdf/fresnel.h"

namespace covtrace {

uint64_t bits_of(Vec3 w) {
    return hash_combine(std::bit_cast<uint32_t>(w.x), std::bit_cast<uint32_t>(w.y),
                        std::bit_cast<uint32_t>(w.z));
}

Rng walk_numbers(Vec3 wo, float u_lobe, Vec2 u) {
    return Rng(hash_combine(bits_of(wo), std::bit_cast<uint32_t>(u_lobe),
                            std::bit_cast<uint32_t>(u.x), std::bit_cast<uint32_t>(u.y)));
}

std::optional<CoatCrossing> enter_coat(const DielectricBsdf& coat, Vec3 w, Vec2 u) {
    const float eta = coat.eta;
    if (is_specular(coat)) {
        const DielectricFresnel f = fresnel_dielectric(w.z, eta);
        if (f.cos_t == 0) return {};
        return CoatCrossing{{-w.x / eta, -w.y / eta, -f.cos_t}, 1 - f.reflectance, 1};
    }
    const Ggx ggx = ggx_of(coat);
    const Vec3 m = ggx.sample_visible_normal(w, u);
    const float cos_o = dot(w, m);
    if (!(cos_o > 0)) return {};
    const DielectricFresnel f = fresnel_dielectric(cos_o, eta);
    const Vec3 in = normalize(m * (cos_o / eta - f.cos_t) - w / eta);
    if (!(in.z < 0) || !(f.reflectance < 1)) return {};
    const float pdf =
        ggx.visible_normal_pdf(w, m) * sqr(eta) * f.cos_t / sqr(eta * f.cos_t - cos_o);
    if (!(pdf > 0) || !std::isfinite(pdf)) return {};
    return CoatCrossing{in, (1 - f.reflectance) * ggx.g2_over_g1(w, mirror_z(in)), pdf};
}

float enter_coat_pdf(const DielectricBsdf& coat, Vec3 w, Vec3 in) {
    const float eta = coat.eta;
    const Vec3 half = w + in * eta;
    const float length2 = length_squared(half);
    if (!(length2 > 0)) return 0;
    const Vec3 m = half / std::copysign(std::sqrt(length2), half.z);
    if (!(dot(w, m) > 0) || !(dot(in, m) < 0)) return 0;
    return ggx_of(coat).visible_normal_pdf(w, m) * sqr(eta) * std::abs(dot(in, m)) / length2;
}

std::optional<CoatCrossing> reflect_below_coat(const DielectricBsdf& coat, Vec3 w, Vec2 u) {
    w = mirror_z(w);
    const float eta = 1 / coat.eta;
    if (is_specular(coat))
        return CoatCrossing{{-w.x, -w.y, -w.z}, fresnel_dielectric(w.z, eta).reflectance, 1};
    const Ggx ggx = ggx_of(coat);
    const Vec3 m = ggx.sample_visible_normal(w, u);
    const float cos_o = dot(w, m);
    if (!(cos_o > 0)) return {};
    const Vec3 out = normalize(m * (2 * cos_o) - w);
    if (!(out.z > 0)) return {};
    return CoatCrossing{mirror_z(out),
                        fresnel_dielectric(cos_o, eta).reflectance * ggx.g2_over_g1(w, out), 1};
}

}  // namespace covtrace
