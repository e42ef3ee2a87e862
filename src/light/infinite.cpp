/// Lights that are infinitely far away, among all others: distant lights without extent and the
/// sky, which is all others together.
#include <algorithm>

#include "light/lights_impl.h"
#include "light/weight.h"

namespace covtrace {

namespace {

/// Least probability of choosing finite lights, and of infinite ones unless all are even skies: the
/// estimates know no shadows, so neither group is taken for negligible by them.
constexpr float kSmallestShare = 0.1f;

}  // namespace

float Lights::Impl::infinite_weight(const InfiniteShare& share, size_t i, Vec3 p, Vec3 n) const {
    if (i >= distants.size()) {
        if ((environment_visible_to[i - distants.size()] & kScatteredRays) == 0) return 0;
        const Environment& e = environments[i - distants.size()];
        return e.irradiance(p, n) * (e.is_even() ? share.even : 1.0f);
    }
    const float facing = choice_weight(distants[i].irradiance);
    return n == Vec3{} ? facing : facing * side_weight(dot(distants[i].direction, n));
}

InfiniteShare Lights::Impl::infinite_share(Vec3 p, Vec3 n) const {
    InfiniteShare share;
    if (infinite_count() == 0) return share;
    float even = 0;
    for (size_t i = 0; i < infinite_count(); ++i) {
        const bool is_even = i >= distants.size() && environments[i - distants.size()].is_even();
        (is_even ? even : share.weight) += infinite_weight(share, i, p, n);
    }
    const float finite = tree.irradiance(p, n);
    const bool has_uneven = share.weight > 0;
    if (even > 0) {
        // An even sky (uniform infinite light) is found by BSDFs, too: it counts with half of what
        // it outshines everything else by (docs/decisions/0074).
        const float rest = finite + share.weight;
        share.even = 0.5f * std::max(0.0f, 1 - rest / even);
        share.weight += share.even * even;
    }
    if (!(share.weight > 0)) return share;
    share.probability = finite > 0
                            ? std::clamp(share.weight / (share.weight + finite),
                                         has_uneven ? kSmallestShare : 0.0f, 1 - kSmallestShare)
                            : 1.0f;
    return share;
}

void Lights::prefetch_environment(Vec3 w) const {
    for (const Environment& environment : impl_->environments) environment.prefetch(w);
}

Rgb Lights::Impl::environment(Vec3 p, Vec3 w, RayKind kind) const {
    Rgb sum;
    for (size_t i = 0; i < environments.size(); ++i)
        if (contains(environment_visible_to[i], kind)) sum += environments[i].radiance(p, w);
    return sum;
}

Lights::Sky Lights::Impl::sky(const InfiniteShare& share, Vec3 p, Vec3 n, Vec3 w,
                              const SkyCell* cell, RayKind kind) const {
    Sky sky;
    float weights = 0, discs = 0;
    for (size_t i = 0; i < environments.size(); ++i) {
        const EnvironmentMap::Sight sight = environments[i].look(p, n, w);
        const float weight = infinite_weight(share, distants.size() + i, p, n);
        if (contains(environment_visible_to[i], kind)) sky.radiance += sight.radiance;
        if (!(weight > 0)) continue;
        if (environments[i].disc()) {
            discs += weight * sight.pdf;
        } else {
            sky.pdf += weight * sight.pdf;
            weights += weight;
        }
    }
    if (cell) sky.pdf = (1 - cell->share) * sky.pdf + cell->share * weights * cell->pdf(w);
    sky.pdf += discs;
    sky.pdf *= share.probability > 0 ? share.probability / share.weight : 0;
    return sky;
}

std::optional<LightSample> Lights::Impl::sample_infinite(const InfiniteShare& share, Vec3 p, Vec3 n,
                                                         float u_select, Draw draw,
                                                         const SkyCell* cell,
                                                         bool looks_later) const {
    // The last light with any weight takes the probability that rounding leaves over.
    float rest = u_select * share.weight, chosen_weight = 0;
    size_t chosen = 0;
    for (size_t i = 0; i < infinite_count(); ++i) {
        const float weight = infinite_weight(share, i, p, n);
        if (!(weight > 0)) continue;
        chosen = i;
        chosen_weight = weight;
        if (rest < weight) break;
        rest -= weight;
    }
    LightSample s;
    s.light = first_distant() + static_cast<int>(chosen);
    if (chosen < distants.size()) {
        s.wi = distants[chosen].direction;
        s.radiance = distants[chosen].irradiance;
        s.pdf = share.probability * chosen_weight / share.weight;
        s.is_delta = true;
        return s;
    }
    const Environment& environment_light = environments[chosen - distants.size()];
    if (cell && !environment_light.disc() && rest / chosen_weight < cell->share) {
        s.wi = cell->sample(draw.u);
        if (looks_later) {
            environment_light.prefetch(s.wi);
            s.is_to_be_looked_at = true;
            return s;
        }
    } else {
        advance(environment_light, draw, 2);
        s.wi = environment_light.direction(p, n, draw.sky);
    }
    // Where the kinds differ, whoever asks for the light of one of them looks again.
    const Sky there = sky(share, p, n, s.wi, cell, kinds_differ ? RayKind::any : RayKind::diffuse);
    s.radiance = there.radiance;
    s.pdf = there.pdf;
    if (!(s.pdf > 0) || is_black(s.radiance)) return std::nullopt;
    return s;
}

void Lights::Impl::advance(const Environment& light, Draw& draw, int steps) const {
    if (draw.steps < 1 && steps >= 1) draw.sky = light.begin_draw(draw.u);
    if (draw.steps < 2 && steps >= 2) light.choose_texel(draw.sky);
    draw.steps = std::max(draw.steps, steps);
}

}  // namespace covtrace
