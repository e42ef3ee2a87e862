/// The next direction of a path, by the BSDF or by the guide to caustics, and its density.
#include <array>
#include <cmath>

#include "bsdf/models.h"
#include "integrator/path_tracer.h"
#include "scene/dispersion.h"

namespace covtrace {

namespace {

/// GGX alpha below which filters are told of objects behind a lobe: Cycles' denoising features draw
/// the line there, too, and a sweep over thirteen scenes found nothing better
/// (docs/decisions/0086).
constexpr float kSeenThrough = 0.075f;

RayKind kind_of(const Bsdf& bsdf, LobeKind lobe) {
    // Light that has walked through a body counts as reflected by it, as in Cycles
    if (const auto* body = std::get_if<SubsurfaceBsdf>(&bsdf); body && body->is_left)
        return RayKind::diffuse;
    if (is_transmission(lobe)) return RayKind::transmission;
    return is_diffuse(lobe) ? RayKind::diffuse : RayKind::glossy;
}

}  // namespace

float PathTracer::mixed_pdf(float own, Vec3 wi) const {
    const float by_paths = path_mixture_.share();
    if (by_paths > 0) own = std::lerp(own, path_mixture_.pdf(wi), by_paths);
    const float share = guide_.share();
    return share > 0 ? (1 - share) * own + share * guide_.pdf(wi) : own;
}

BsdfValue PathTracer::eval_direction(const Surface& surface, Vec3 wi_local, Vec3 wi) const {
    const BsdfValue own = eval_and_pdf(surface.bsdf, surface.wo, wi_local);
    return {own.f, mixed_pdf(own.pdf, wi)};
}

std::optional<BsdfSample> PathTracer::sample_direction(const Surface& surface, float u_lobe,
                                                       Vec2 u) {
    const float by_caustics = guide_.share(), by_paths = path_mixture_.share();
    const float share = by_caustics + (1 - by_caustics) * by_paths;
    if (!(share > 0)) return sample(surface.bsdf, surface.wo, u_lobe, u);
    std::optional<BsdfSample> s;
    BsdfValue own;
    Vec3 wi;
    if (u_lobe < share) {
        wi = u_lobe < by_caustics
                 ? guide_.sample(u_lobe / by_caustics, u)
                 : path_mixture_.sample((u_lobe - by_caustics) / (share - by_caustics), u);
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

PathTracer::ChosenKind PathTracer::choose_kind(const Surface& surface, Vec3 wi_local, Rgb value,
                                               float u) const {
    if (!scene_.kinds_differ) return {};
    const LobeShares shares = lobe_shares(surface.bsdf, surface.wo, wi_local, value);
    // Sum the lobes of each kind
    constexpr std::array kKinds{RayKind::diffuse, RayKind::glossy, RayKind::transmission};
    std::array<Rgb, kKinds.size()> parts{};
    Rgb all;
    for (size_t i = 0; i < size_t(shares.count); ++i) {
        const LobeShare& lobe = shares.lobes[i];
        for (size_t k = 0; k < kKinds.size(); ++k)
            if (kind_of(surface.bsdf, lobe.kind) == kKinds[k]) parts[k] += lobe.value;
        all += lobe.value;
    }
    const float total = luminance(all);
    if (!(total > 0)) return {RayKind::diffuse, Rgb(1)};
    // Choose one by its luminance, the last one with any where rounding leaves something over
    ChosenKind chosen;
    for (size_t k = 0; k < kKinds.size(); ++k) {
        const float probability = luminance(parts[k]) / total;
        if (!(probability > 0)) continue;
        chosen.kind = kKinds[k];
        for (int c = 0; c < 3; ++c)
            chosen.factor[c] = all[c] > 0 ? parts[k][c] / (all[c] * probability) : 0.0f;
        if (u < probability) break;
        u -= probability;
    }
    return chosen;
}

void PathTracer::disperse(DielectricBsdf& glass) {
    const bool is_first = !wavelength_;
    if (is_first) wavelength_ = sample_wavelength(sampler_.pair(kWavelengthPair).x);
    glass.eta *= glass.dispersion->at(wavelength_->nanometres);
    if (is_first && !is_specular(glass)) take_wavelength();
}

void PathTracer::take_wavelength() {
    colourless_beta_ = beta_;
    beta_ *= wavelength_->weight;
    has_wavelengths_colour_ = true;
}

bool PathTracer::scatter(const Surface& surface, float u_lobe, Vec2 u, float u_kind,
                         PathVertex* vertex) {
    // Sample the BSDF or the guide
    auto s = sample_direction(surface, u_lobe, u);
    if (!s || is_black(s->weight)) return false;
    if (enters_body(surface.bsdf, *s) || goes_back_in(surface, *s))
        return enter_body(surface, *s, vertex);
    body_.reset();
    // Choose the kind of ray. A pair of directions that several lobes have is split among them, as
    // it is where the light of a lamp is sampled
    ray_.kind = kind_of(surface.bsdf, s->lobe);
    const Rgb value = s->weight * s->pdf;
    if (scene_.kinds_differ && !is_specular(s->lobe)) {
        const ChosenKind chosen = choose_kind(surface, s->wi, value, u_kind);
        ray_.kind = chosen.kind;
        s->weight *= chosen.factor;
        if (is_black(s->weight)) return false;
    }
    const Vec3 wi = normalize(surface.frame.to_world(s->wi));
    // Take a wavelength where the colours part. A mirror image keeps all of them: glass reflects
    // them nearly alike, and in the same direction
    if (wavelength_ && !has_wavelengths_colour_) {
        if (is_transmission(s->lobe))
            take_wavelength();
        else
            wavelength_.reset();
    }
    // Update the path's throughput and what is known of its lobes
    beta_ *= s->weight;
    colourless_beta_ *= s->weight;
    pdf_ = s->pdf;
    specular_ = is_specular(s->lobe);
    sharp_so_far_ = sharp_so_far_ && specular_;
    if (sharp_so_far_ && scene_.has_open_walls) ray_.kind = RayKind::camera;
    seen_clearly_ =
        seen_clearly_ && !is_diffuse(s->lobe) && sharp_lobe_roughness(surface.bsdf) < kSeenThrough;
    sharp_probability_ *= s->pdf;
    if (is_transmission(s->lobe)) roulette_scale_ *= s->eta * s->eta;
    // Record the event
    if (vertex) {
        vertex->scatters = true;
        vertex->next_event.wi = wi;
        vertex->next_value = luminance(s->weight) * s->pdf;
        vertex->next_bsdf_pdf = specular_ ? 0 : pdf(surface.bsdf, surface.wo, s->wi);
        if (specular_) {
            vertex->next_event.lobes.count = 1;
            vertex->next_event.lobes.lobes[0] = {s->lobe, s->weight, 0, 0, s->eta};
        } else {
            vertex->next_event.lobes = lobe_shares(surface.bsdf, surface.wo, s->wi, value);
        }
    }
    // Move the ray to the surface, into the medium beyond
    const SurfaceHit& hit = surface.hit;
    medium_ = medium_beyond(surface.shape, hit, wi, medium_);
    specular_way_ = specular_ ? specular_way_ + distance(ray_begin_, hit.position) : 0;
    ray_.origin = ray_begin_ = Geometry::offset_origin(hit, wi);
    ray_.direction = wi;
    ray_.t_max = kInfinity;
    if (specular_)
        leave_specular(hit, surface.shape, *s);
    else
        leave(mirror_share_);
    return true;
}

}  // namespace covtrace
