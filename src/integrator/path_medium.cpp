/// A path's way through a medium, which absorbs, glows, and may scatter before the next surface.
#include <algorithm>
#include <cmath>

#include "bsdf/phase_function.h"
#include "integrator/path_tracer.h"

namespace covtrace {

MediumEvent PathTracer::cross_medium(float length) {
    const Medium& medium = scene_.media[static_cast<size_t>(medium_)];
    const MediumWay way(medium, ray_.origin, ray_.direction);
    // Add emission
    const uint32_t piece = static_cast<uint32_t>(passed_interfaces_) +
                           static_cast<uint32_t>(depth_) * (kMostInterfaces + 1);
    if (depth_ < max_depth_ && medium.emits()) {
        const float u = medium.glow || medium.source ? sampler_.pair(kGlowPairs + piece).x : 0;
        const Rgb contribution = beta_ * emitted_along(medium, way, length, u);
        result_.radiance += contribution;
        if (record_) glow_ += luminance(contribution);
    }
    // Sample the distance at which the medium scatters
    MediumEvent event{false, length, {}, {}};
    if (depth_ < max_depth_ && medium.scatters()) {
        sampler_.set_dimension(kMediumPairs + piece);
        Vec2 u = sampler_.next_2d();
        const std::optional<LightBeside> light = light_beside(length, u.x);
        event = sample_event(medium, way, length, beta_, u, light);
    } else {
        event.weight = transmittance(medium, way.column(length));
        event.through = event.weight;
    }
    beta_ *= event.weight;
    return event;
}

std::optional<LightBeside> PathTracer::light_beside(float length, float& u) const {
    if (!(length > 0 && std::isfinite(length))) return std::nullopt;
    const auto light = scene_.lights.choose_beside(ray_.origin, ray_.direction, length, u);
    if (!light) return std::nullopt;
    const Vec3 to_light = light->ball.center - ray_.origin;
    const float along = dot(to_light, ray_.direction);
    // Within a lamp, and where the ray meets a point, the angle tells nothing
    constexpr float kNearest = 1e-6f;  // of the length
    const float away = std::max({covtrace::length(to_light - along * ray_.direction),
                                 light->ball.radius, kNearest * std::max(length, std::abs(along))});
    return LightBeside{along, away, light->share};
}

bool PathTracer::scatter_in_medium(float distance) {
    if (is_black(beta_)) return false;
    const Medium& medium = scene_.media[static_cast<size_t>(medium_)];
    const Vec3 wo = -ray_.direction;
    SurfaceHit place;
    place.position = ray_.origin + ray_.direction * distance;
    place.time = ray_.time;
    place.sample = ray_.sample;
    // Begin the vertex
    PathVertex* vertex = begin_vertex(place, medium_, wo);
    if (seen_clearly_) describe_vertex(place.position, medium.albedo(), {});
    ++depth_;
    sampler_.set_dimension(static_cast<uint32_t>(depth_) * kPairsPerBounce);
    const auto [u_choice, u_light, u_phase, u_roulette] = sampler_.next_four_2d();
    // Sample direct illumination
    lit_ = {place.position, {}};
    Ray shadow;
    shadow.origin = place.position;
    shadow.time = place.time;
    shadow.sample = place.sample;
    shadow.kind = RayKind::volume;
    if (const auto light =
            scene_.lights.sample(place.position, {}, place.time, u_choice.x, u_light)) {
        const float p = henyey_greenstein(medium.g, -dot(wo, light->wi));
        keep_light(*light, {Rgb(p), p}, shadow, medium_, vertex);
    }
    // Sample the phase function for the next direction
    const Vec3 wi = sample_phase(medium.g, wo, u_phase);
    pdf_ = henyey_greenstein(medium.g, -dot(wo, wi));
    specular_ = sharp_so_far_ = seen_clearly_ = false;
    if (vertex) {
        vertex->scatters = true;
        vertex->next_event = {wi, {}};
    }
    specular_way_ = 0;
    ray_.origin = ray_begin_ = place.position;
    ray_.direction = wi;
    ray_.kind = RayKind::volume;
    leave(0);
    return survives(u_roulette.x);
}

}  // namespace covtrace
