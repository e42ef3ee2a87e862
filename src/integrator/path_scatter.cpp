/// The next direction of a path, by the BSDF or by the guide to caustics, and its density.
#include <cmath>

#include "integrator/path_tracer.h"

namespace covtrace {

namespace {

/// GGX alpha below which filters are told of objects behind a lobe: Cycles' denoising features draw
/// the line there, too, and a sweep over thirteen scenes found nothing better
/// (docs/decisions/0086).
constexpr float kSeenThrough = 0.075f;

}  // namespace

float PathTracer::mixed_pdf(float own, Vec3 wi) const {
    const float share = guide_.share();
    return share > 0 ? (1 - share) * own + share * guide_.pdf(wi) : own;
}

BsdfValue PathTracer::eval_direction(const Surface& surface, Vec3 wi_local, Vec3 wi) const {
    const BsdfValue own = eval_and_pdf(surface.bsdf, surface.wo, wi_local);
    return {own.f, mixed_pdf(own.pdf, wi)};
}

std::optional<BsdfSample> PathTracer::sample_direction(const Surface& surface, float u_lobe,
                                                       Vec2 u) {
    const float share = guide_.share();
    if (!(share > 0)) return sample(surface.bsdf, surface.wo, u_lobe, u);
    std::optional<BsdfSample> s;
    BsdfValue own;
    Vec3 wi;
    if (u_lobe < share) {
        wi = guide_.sample(u_lobe / share, u);
        s = BsdfSample{};
        s->wi = surface.frame.to_local(wi);
        s->lobe = s->wi.z * surface.wo.z > 0 ? LobeKind::diffuse_reflection
                                             : LobeKind::diffuse_transmission;
        own = eval_and_pdf(surface.bsdf, surface.wo, s->wi);
    } else {
        s = sample(surface.bsdf, surface.wo, (u_lobe - share) / (1 - share), u);
        if (!s) return s;
        if (is_specular(s->lobe)) {
            s->weight *= 1 / (1 - share);
            s->pdf *= 1 - share;
            return s;
        }
        wi = surface.frame.to_world(s->wi);
        own = {s->weight * s->pdf, s->pdf};
    }
    s->pdf = mixed_pdf(own.pdf, wi);
    s->weight = s->pdf > 0 ? own.f * (1 / s->pdf) : Rgb(0);
    // Let the roulette judge the path as if the BSDF had chosen alone: a throughput that is small
    // because the guide expects much light from there must not end the path
    if (own.pdf > 0) roulette_scale_ *= s->pdf / own.pdf;
    return s;
}

bool PathTracer::scatter(const Surface& surface, float u_lobe, Vec2 u, PathVertex* vertex) {
    // Sample the BSDF or the guide
    const auto s = sample_direction(surface, u_lobe, u);
    if (!s || is_black(s->weight)) return false;
    const Vec3 wi = normalize(surface.frame.to_world(s->wi));
    // Update the path's throughput and what is known of its lobes
    beta_ *= s->weight;
    pdf_ = s->pdf;
    specular_ = is_specular(s->lobe);
    sharp_so_far_ = sharp_so_far_ && specular_;
    seen_clearly_ =
        seen_clearly_ && !is_diffuse(s->lobe) && sharp_lobe_roughness(surface.bsdf) < kSeenThrough;
    sharp_probability_ *= s->pdf;
    if (is_transmission(s->lobe)) roulette_scale_ *= s->eta * s->eta;
    // Record the event
    if (vertex) {
        vertex->scatters = true;
        vertex->next_event.wi = wi;
        if (specular_) {
            vertex->next_event.lobes.count = 1;
            vertex->next_event.lobes.lobes[0] = {s->lobe, s->weight, 0, 0, s->eta};
        } else {
            vertex->next_event.lobes =
                lobe_shares(surface.bsdf, surface.wo, s->wi, s->weight * s->pdf);
        }
    }
    // Move the ray to the surface, into the medium beyond
    const SurfaceHit& hit = surface.hit;
    previous_position_ = hit.position;
    previous_normal_ = light_normal_;
    medium_ = medium_beyond(surface.shape, hit, wi, medium_);
    ray_.origin = Geometry::offset_origin(hit, wi);
    ray_.direction = wi;
    ray_.t_max = kInfinity;
    return true;
}

}  // namespace covtrace
