/// The light that a path finds: sampled at a vertex (`add_direct`), emitted where it hits, from the
/// sky where it leaves the scene.
#include <cmath>

#include "geometry/leave_surface.h"
#include "integrator/path_tracer.h"

namespace covtrace {

namespace {

/// Whether it is known that a sample brings no light.
bool is_without_light(const LightSample& light) {
    return !light.is_to_be_looked_at && (is_black(light.radiance) || !(light.pdf > 0));
}

}  // namespace

void PathTracer::record_last_way(float length) {
    if (!record_ || record_->count != static_cast<int>(result_.vertices)) return;
    record_->escape_direction = ray_.direction;
    record_->escape_glow = glow_;
    record_->last_way = length;
}

void PathTracer::escape() {
    record_last_way(kInfinity);
    if (looks_straight()) tell_opacity_of_sky();
    // Add light of the environment
    if (!scene_.lights.has_environment()) return;
    Lights::Sky sky;
    // Weight it against light sampling, which could not find it by a specular lobe
    float weight = 1;
    if (specular_) {
        sky.radiance = scene_.lights.environment(ray_.origin, ray_.direction, ray_.kind);
        if (came_through_panes() && !is_black(sky.radiance)) weight = weight_through_panes();
        if (came_by_mirror() && !is_black(sky.radiance)) weight = weight_by_mirror(nullptr);
    } else {
        sky =
            scene_.lights.sky(lit_.position, lit_.normal, ray_.direction, lit_.sky_cell, ray_.kind);
        weight = power_heuristic(pdf_, sky.pdf);
        if (sky.pdf > 0 && is_shadowed(nullptr)) weight = 0;
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
    const float way =
        sharp_so_far_ ? kInfinity : specular_way_ + distance(ray_begin_, hit.position);
    const Rgb light = scene_.lights.emitted(hit, wo, way);
    if (is_black(light)) return;
    // Weight the emission against light sampling, which could not find it by a specular lobe
    float weight = 1;
    if (!specular_) {
        const float p =
            scene_.lights.pdf(lit_.position, lit_.normal, ray_.direction, hit, lit_.lamp_factors);
        weight = power_heuristic(pdf_, p);
        if (p > 0 && is_shadowed(&hit)) weight = 0;
    } else if (came_through_panes()) {
        weight = weight_through_panes();
    } else if (came_by_mirror()) {
        weight = weight_by_mirror(&hit);
    }
    const Rgb contribution = beta_ * light * weight;
    result_.radiance += contribution;
    if (in_view()) result_.in_view += contribution;
    if (vertex) vertex->emitted = luminance(contribution);
}

bool PathTracer::is_shadowed(const SurfaceHit* hit) {
    if (!scene_.shadows_differ) return false;
    Ray shadow = ray_;
    shadow.origin = ray_begin_;
    if (hit && !(aim(shadow, end_before(*hit, shadow.origin)) > 0)) return false;
    ++result_.rays.shadow;
    return scene_.geometry.occluded(shadow);
}

void PathTracer::add_direct(const Surface& surface, float u_select, Vec2 u, float u_kind,
                            PathVertex* vertex) {
    const SurfaceHit& hit = surface.hit;
    // Sample a light
    const auto light = scene_.lights.finish_draw(
        hit.position, lit_.normal, hit.time, u_select,
        draws_ahead_ ? light_draw_ : Lights::Draw{u, {}, 0}, lit_.sky_cell, lit_.lamp_factors,
        !vertex && !scene_.lights.kinds_differ());
    if (!light || is_without_light(*light)) return;
    // Evaluate the BSDF for its direction
    const Vec3 wi_local = surface.frame.to_local(light->wi);
    const BsdfValue value = eval_direction(surface, wi_local, light->wi);
    if (is_black(value.f)) return;
    const ChosenKind chosen = choose_kind(surface, wi_local, value.f, u_kind);
    // Trace a shadow ray and add the light
    Ray shadow;
    shadow.origin = Geometry::offset_origin(hit, light->wi);
    shadow.time = hit.time;
    shadow.sample = hit.sample;
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
    if (is_without_light(light)) return false;
    // Aim at the light from the moved origin
    if (!(aim(shadow, light) > 0)) return false;
    // Find the way to the point itself from differences of near points, which are exact
    Vec3 to_point = shadow.direction;
    if (samples_through_panes_ && std::isfinite(light.distance))
        to_point = normalize(light.wi * light.distance - (shadow.origin - lit_.position));
    sampled_light_ = {shadow,
                      to_point,
                      light.distance,
                      medium,
                      beta_ * value.f,
                      light.radiance,
                      light.pdf,
                      light.is_to_be_looked_at,
                      light.is_delta ? 0.0f : value.pdf,
                      lit_,
                      vertex};
    if (vertex) {
        vertex->light = light;
        vertex->direct_event = {light.wi, {}};
    }
    return true;
}

bool PathTracer::look_at(SampledLight& light) const {
    const LitPlace& place = light.place;
    const Lights::Sky sky = scene_.lights.sky(place.position, place.normal, light.ray.direction,
                                              place.sky_cell, light.ray.kind);
    light.radiance = sky.radiance;
    light.pdf = sky.pdf;
    return light.pdf > 0 && !is_black(light.radiance);
}

void PathTracer::add_sampled_light(bool occluded) {
    ++result_.rays.shadow;
    // No way through panes leads to a light without extent
    const bool goes_through_panes =
        occluded && samples_through_panes_ && sampled_light_->path_pdf > 0;
    if (occluded && !goes_through_panes) {
        sampled_light_.reset();
        return;
    }
    if (sampled_light_->is_to_be_looked_at && !look_at(*sampled_light_)) {
        sampled_light_.reset();
        return;
    }
    if (goes_through_panes) return;
    const SampledLight light = *sampled_light_;
    sampled_light_.reset();
    const Rgb visible =
        visibility(scene_, light.ray, light.distance, light.medium, result_.rays.shadow);
    if (is_black(visible)) return;
    // Where no path of the ray's kind gets from here to the light it is found by sampling alone
    const bool is_found_alone =
        scene_.shadows_differ && is_met(scene_, light.ray, result_.rays.shadow);
    const float weight = is_found_alone ? 1.0f : power_heuristic(light.pdf, light.path_pdf);
    const Rgb contribution = light.scattered * light.radiance * visible * (weight / light.pdf);
    result_.radiance += contribution;
    if (light.vertex) light.vertex->direct = luminance(contribution);
}

}  // namespace covtrace
