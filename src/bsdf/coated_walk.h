/// Light between a dielectric coat and what it covers: how it crosses the coat, and pbrt-v4's
/// random walk where the gap between both scatters.
///
/// Light that crosses the gap along w goes on with probability A(w) = exp(-thickness / |w.z|). In
/// between it is scattered by Henyey and Greenstein's phase function, and keeps the share `albedo`
/// of each channel. The estimate connects every event with wi: one at the base or in the gap by
/// wi's refracted direction, and the direction in which such an event sends light on with a rough
/// coat, by multiple importance sampling (Veach 1997, "Robust Monte Carlo methods for light
/// transport simulation", chapter 9). Where coat and base are both smooth, the mirror images that
/// they make of each other are summed as series; pbrt leaves them out.
///
/// Directions are those in which the walk goes, z < 0 downwards; depths are below the coat, in
/// optical depths.
#pragma once

#include "bsdf/gap_spectrum.h"
#include "bsdf/ggx.h"
#include "bsdf/models.h"
#include "bsdf/phase_function.h"
#include "core/rng.h"

namespace covtrace {

inline Ggx ggx_of(const DielectricBsdf& coat) {
    return {coat.alpha_x, coat.alpha_y};
}

/// A direction through the coat, or off its inside: which of the two was decided before, so that
/// the weight holds Fresnel's share. For refraction it has no factor 1 / eta^2.
struct CoatCrossing {
    Vec3 w;
    float weight = 0;
    float pdf = 0;  ///< density of refraction through a rough coat, else 1
};

/// Samples a refraction from the outside direction w (w.z > 0) to one inside (z < 0).
std::optional<CoatCrossing> enter_coat(const DielectricBsdf& coat, Vec3 w, Vec2 u);
/// Density of `enter_coat` on a rough coat to give the direction `in`.
float enter_coat_pdf(const DielectricBsdf& coat, Vec3 w, Vec3 in);
/// Samples a reflection off the coat's inside. `w` (z < 0) points back to where the walk came from;
/// the result, with z < 0 too, is the direction in which the walk goes on.
std::optional<CoatCrossing> reflect_below_coat(const DielectricBsdf& coat, Vec3 w, Vec2 u);

uint64_t bits_of(Vec3 w);
/// Random numbers of a sample's walk.
Rng walk_numbers(Vec3 wo, float u_lobe, Vec2 u);

inline float power_heuristic(float a, float b) {
    return sqr(a) / (sqr(a) + sqr(b));
}

/// A base under a coat.
template <typename Base>
struct CoatLayers {
    const DielectricBsdf& coat;
    const Base& base;
    float thickness;
    const GapScattering& gap;
    /// Whether the base is a mirror.
    bool is_base_smooth() const {
        if constexpr (requires { base.alpha_x; }) return base.alpha_x == 0 && base.alpha_y == 0;
        return false;
    }
};

/// Estimate of a walk: light that was scattered in the gap, and all other.
struct CoatWalkSum {
    Rgb straight, scattered;
};

/// Mean of `samples` walks for a pair of directions outside, times the cosine of wi: `one` makes an
/// estimate from both directions and random numbers, which are the same for the same pair at a
/// place. A pair is put into one order first where the model is reciprocal.
template <typename Walk>
CoatWalkSum mean_of_walks(Vec3 wo, Vec3 wi, bool is_reciprocal, uint32_t place, int samples,
                          Walk one) {
    constexpr float kGrazing = 1e-6f;  // below, the walk's quotients overflow
    if (std::min(wo.z, wi.z) < kGrazing) return {};
    const float scale = wi.z / static_cast<float>(samples);
    uint64_t hash_o = bits_of(wo), hash_i = bits_of(wi);
    if (hash_o > hash_i && is_reciprocal) {
        std::swap(wo, wi);
        std::swap(hash_o, hash_i);
    }
    Rng rng(hash_combine(hash_o, hash_i, place));
    CoatWalkSum sum;
    for (int i = 0; i < samples; ++i) {
        const CoatWalkSum estimate = one(wo, wi, rng);
        sum.straight += estimate.straight;
        sum.scattered += estimate.scattered;
    }
    return {sum.straight * scale, sum.scattered * scale};
}

/// Events that light meets on its way through the gap.
enum class GapEvent { scattering, base, coat };

/// Goes along `way` from `depth` to the next event, and changes the depth to its.
inline GapEvent advance_in_gap(float thickness, Vec3 way, float& depth, float u) {
    const float next = depth + std::log1p(-u) * way.z;
    if (next > 0 && next < thickness) {
        depth = next;
        return GapEvent::scattering;
    }
    depth = way.z < 0 ? thickness : 0;
    return way.z < 0 ? GapEvent::base : GapEvent::coat;
}

/// Ends walks that carry little light after some events, as pbrt-v4 does, and gives the others
/// theirs. Returns whether a walk goes on. `carried`: its light, `weight`: a factor of it.
inline bool survives_roulette(int event, Rgb carried, Rgb& weight, Rng& rng) {
    constexpr int kSureEvents = 4;
    constexpr float kLittle = 0.25f;
    const float most = max_component(carried);
    if (!(most > 0)) return false;
    if (event < kSureEvents || most >= kLittle) return true;
    if (rng.next_float() >= most) return false;
    weight *= Rgb(1 / most);
    return true;
}

/// A walk for a pair of directions, both outside (z > 0).
template <typename Base>
class CoatWalk {
  public:
    CoatWalk(const CoatLayers<Base>& layers, Vec3 wo, Vec3 wi, Rng& rng)
        : l_(layers),
          wi_(wi),
          rng_(rng),
          smooth_coat_(is_specular(layers.coat)),
          smooth_base_(layers.is_base_smooth()),
          first_(enter_coat(layers.coat, wo, rng.next_2d())),
          last_(enter_coat(layers.coat, wi, rng.next_2d())),
          colour_(layers.gap) {}

    /// Estimate of f without what the coat reflects.
    CoatWalkSum run() {
        if (!first_) return {};
        way_ = first_->w;
        beta_ = Rgb(first_->weight / sqr(l_.coat.eta));
        bool goes_on = true;
        for (int event = 0; goes_on && event < l_.gap.events; ++event) {
            switch (advance_in_gap(l_.thickness, way_, depth_, rng_.next_float())) {
                case GapEvent::scattering:
                    scatter();
                    break;
                case GapEvent::base:
                    goes_on = meet_base();
                    break;
                case GapEvent::coat:
                    goes_on = meet_coat();
                    break;
            }
            goes_on = goes_on && survives_roulette(event, beta_ * colour_.value(), beta_, rng_);
        }
        return sum_;
    }

  private:
    void add(Rgb value) {
        (is_scattered_ ? sum_.scattered : sum_.straight) += beta_ * colour_.value() * value;
    }
    float passed(float depth, Vec3 w) const { return std::exp(-depth / std::abs(w.z)); }

    /// Adds light that leaves through a rough coat in the direction of the walk, which was sampled
    /// with density `pdf`; 0: by a mirror.
    void add_through_coat(float pdf) {
        if (smooth_coat_ || !(way_.z > 0)) return;
        const float share = pdf > 0 ? power_heuristic(pdf, enter_coat_pdf(l_.coat, wi_, -way_)) : 1;
        add(Rgb(eval(l_.coat, -way_, wi_).r * share * passed(depth_, way_) / wi_.z));
    }

    /// Light that was scattered at the depth and leaves along `up` without another scattering, but
    /// for the phase function: as it is seen through the coat, and in the base where that is a
    /// mirror under a smooth coat.
    void add_scattered(Vec3 up) {
        const float towards = henyey_greenstein(l_.gap.g, dot(way_, up));
        const float weight = last_->weight / up.z;
        if (!smooth_coat_ || !smooth_base_) {
            const float share = smooth_coat_ ? 1 : power_heuristic(last_->pdf, towards);
            add(Rgb(towards * share * weight * passed(depth_, up)));
            return;
        }
        if constexpr (requires { reflectance(l_.base, up.z); }) {
            const float crossed = passed(l_.thickness, up);
            const Rgb mirrored = reflectance(l_.base, up.z);
            const float off_coat = fresnel_dielectric(up.z, 1 / l_.coat.eta).reflectance;
            const float in_base = henyey_greenstein(l_.gap.g, dot(way_, mirror_z(up))) * crossed *
                                  passed(l_.thickness - depth_, up);
            const Rgb once = Rgb(towards * passed(depth_, up)) + in_base * mirrored;
            add(weight * once / (Rgb(1) - (off_coat * sqr(crossed)) * mirrored));
        }
    }

    void scatter() {
        is_scattered_ = true;
        colour_.scatter();
        if (last_) add_scattered(-last_->w);
        const Vec3 before = way_;
        way_ = sample_phase(l_.gap.g, -way_, rng_.next_2d());
        add_through_coat(henyey_greenstein(l_.gap.g, dot(before, way_)));
    }

    bool meet_base() {
        const Vec3 from = -way_;
        colour_.meet_base();
        if (last_ && !smooth_base_) {
            const Vec3 to = -last_->w;
            const float share =
                smooth_coat_ ? 1 : power_heuristic(last_->pdf, pdf(l_.base, from, to));
            add(eval(l_.base, from, to) *
                (share * last_->weight * passed(l_.thickness, to) / to.z));
        }
        const float u_lobe = rng_.next_float();
        const auto s = sample(l_.base, from, u_lobe, rng_.next_2d());
        if (!s) return false;
        way_ = s->wi;
        beta_ *= s->weight;
        add_through_coat(smooth_base_ ? 0 : s->pdf);
        return true;
    }

    bool meet_coat() {
        const auto back = reflect_below_coat(l_.coat, -way_, rng_.next_2d());
        if (!back) return false;
        way_ = back->w;
        beta_ *= Rgb(back->weight);
        return true;
    }

    const CoatLayers<Base> l_;
    const Vec3 wi_;
    Rng& rng_;
    const bool smooth_coat_, smooth_base_;
    const std::optional<CoatCrossing> first_, last_;
    Vec3 way_{};
    Rgb beta_;  ///< share of the light, but for colour_
    GapColour colour_;
    float depth_ = 0;
    bool is_scattered_ = false;
    CoatWalkSum sum_;
};

/// A direction in which light leaves through the coat.
struct CoatExit {
    Vec3 wi;
    Rgb weight;
    bool is_scattered = false;  ///< in the gap
};

/// Follows light that goes down from the coat along `way` until it leaves. Leaving counts as no
/// event, as in CoatWalk.
template <typename Base>
std::optional<CoatExit> follow_to_exit(const CoatLayers<Base>& l, Vec3 way, Rgb weight, Rng& rng) {
    float depth = 0;
    bool is_scattered = false;
    GapColour colour(l.gap);
    for (int event = 0; event <= l.gap.events; ++event) {
        const GapEvent met = advance_in_gap(l.thickness, way, depth, rng.next_float());
        if (event == l.gap.events && met != GapEvent::coat) return {};
        switch (met) {
            case GapEvent::scattering:
                is_scattered = true;
                colour.scatter();
                way = sample_phase(l.gap.g, -way, rng.next_2d());
                break;
            case GapEvent::base: {
                colour.meet_base();
                const float u_lobe = rng.next_float();
                const auto s = sample(l.base, -way, u_lobe, rng.next_2d());
                if (!s) return {};
                weight *= s->weight;
                way = s->wi;
                break;
            }
            case GapEvent::coat: {
                const float u_lobe = rng.next_float();
                const auto s = sample(l.coat, -way, u_lobe, rng.next_2d());
                if (!s) return {};
                weight *= s->weight;
                way = s->wi;
                if (!is_transmission(s->lobe)) break;
                if (!(way.z > 0)) return {};
                return CoatExit{way, weight * colour.value(), is_scattered};
            }
        }
        if (!survives_roulette(event, weight * colour.value(), weight, rng)) return {};
    }
    return {};
}

}  // namespace covtrace
