/// The light that a path finds: sampled at a vertex (`add_direct`), emitted where it hits, from the
/// sky where it leaves the scene.
#include <cmath>

#include "integrator/path_tracer.h"

namespace covtrace {

void PathTracer::escape() {
    if (record_ && record_->count == static_cast<int>(result_.vertices)) {
        record_->escape_direction = ray_.direction;
        record_->escape_glow = glow_;
    }
    // Add light of the environment
    if (!scene_.lights.has_environment()) return;
    Lights::Sky sky;
    // Weight it against light sampling, which could not find it by a specular lobe
    float weight = 1;
    if (specular_) {
        sky.radiance = scene_.lights.environment(ray_.origin, ray_.direction, ray_.kind);
    } else {
        sky = scene_.lights.sky(previous_position_, previous_normal_, ray_.direction, sky_cell_,
                                ray_.kind);
        weight = power_heuristic(pdf_, sky.pdf);
        if (sky.pdf > 0 && is_shadowed(kInfinity)) weight = 0;
    }
    const Rgb contribution = beta_ * sky.radiance * weight;
    result_.radiance += contribution;
    if (in_view()) result_.in_view += contribution;
    if (record_ && record_->count == static_cast<int>(result_.vertices)) {
        record_->escaped = luminance(contribution);
        record_->escape_in_view = in_view();
    }
}

void PathTracer::add_emission(const SurfaceHit& hit, Vec3 wo, PathVertex* vertex) {
    const Rgb light = scene_.lights.emitted(hit, wo);
    if (is_black(light)) return;
    // Weight the emission against light sampling, which could not find it by a specular lobe
    float weight = 1;
    if (!specular_) {
        const float p = scene_.lights.pdf(previous_position_, previous_normal_, ray_.direction, hit,
                                          lamp_factors_);
        weight = power_heuristic(pdf_, p);
        if (p > 0 && is_shadowed(distance(ray_begin_, hit.position))) weight = 0;
    }
    const Rgb contribution = beta_ * light * weight;
    result_.radiance += contribution;
    if (in_view()) result_.in_view += contribution;
    if (vertex) vertex->emitted = luminance(contribution);
}

bool PathTracer::is_shadowed(float distance) {
    if (!scene_.shadows_differ) return false;
    Ray shadow = ray_;
    shadow.origin = ray_begin_;
    shadow.t_max = distance * (1 - 1e-4f);
    ++result_.rays.shadow;
    return scene_.geometry.occluded(shadow);
}

void PathTracer::add_direct(const Surface& surface, float u_select, Vec2 u, float u_kind,
                            PathVertex* vertex) {
    const SurfaceHit& hit = surface.hit;
    // Sample a light
    const auto light = scene_.lights.finish_draw(
        hit.position, light_normal_, hit.time, u_select,
        draws_ahead_ ? light_draw_ : Lights::Draw{u, {}, 0}, sky_cell_, lamp_factors_);
    if (!light || is_black(light->radiance) || !(light->pdf > 0)) return;
    // Evaluate the BSDF for its direction
    const Vec3 wi_local = surface.frame.to_local(light->wi);
    const BsdfValue value = eval_direction(surface, wi_local, light->wi);
    if (is_black(value.f)) return;
    const ChosenKind chosen = choose_kind(surface, wi_local, value.f, u_kind);
    // Trace a shadow ray and add the light
    Ray shadow;
    shadow.origin = Geometry::offset_origin(hit, light->wi);
    shadow.time = hit.time;
    shadow.kind = chosen.kind;
    const MediumId medium = medium_beyond(surface.shape, hit, light->wi, medium_);
    if (keep_light(*light, {value.f * chosen.factor, value.pdf}, shadow, medium, vertex) && vertex)
        vertex->direct_event.lobes = lobe_shares(surface.bsdf, surface.wo, wi_local, value.f);
}

bool PathTracer::keep_light(LightSample light, const BsdfValue& value, Ray shadow, MediumId medium,
                            PathVertex* vertex) {
    if (!contains(light.visible_to, shadow.kind)) return false;
    if (scene_.lights.kinds_differ() && !light.is_delta && !std::isfinite(light.distance))
        light.radiance = scene_.lights.environment(shadow.origin, light.wi, shadow.kind);
    if (is_black(light.radiance) || !(light.pdf > 0)) return false;
    shadow.direction = light.wi;
    if (std::isfinite(light.distance)) {
        // Aim at the light from the moved origin and stop just short of it
        const Vec3 to_light = light.position - shadow.origin;
        const float d = length(to_light);
        if (!(d > 0)) return false;
        shadow.direction = to_light / d;
        shadow.t_max = d * (1 - 1e-4f);
    }
    const float weight = light.is_delta ? 1.0f : power_heuristic(light.pdf, value.pdf);
    sampled_light_ = {
        shadow, light.distance, medium, beta_ * value.f * light.radiance, weight / light.pdf,
        vertex, 1 / light.pdf};
    if (vertex) {
        vertex->light = light;
        vertex->direct_event = {light.wi, {}};
    }
    return true;
}

void PathTracer::add_sampled_light(bool occluded) {
    const SampledLight light = *sampled_light_;
    sampled_light_.reset();
    ++result_.rays.shadow;
    if (occluded) return;
    const Rgb visible =
        visibility(scene_, light.ray, light.distance, light.medium, result_.rays.shadow);
    if (is_black(visible)) return;
    const bool is_found_alone =
        scene_.shadows_differ && is_met(scene_, light.ray, result_.rays.shadow);
    const Rgb contribution =
        light.light * visible * (is_found_alone ? light.weight_alone : light.weight);
    result_.radiance += contribution;
    if (light.vertex) light.vertex->direct = luminance(contribution);
}

}  // namespace covtrace
