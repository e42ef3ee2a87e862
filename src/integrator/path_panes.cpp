/// The ways through panes: by sampled light, and by the path itself.
#include <cmath>

#include "integrator/panes.h"
#include "integrator/path_tracer.h"

namespace covtrace {

namespace {

/// Goes through a pane: empty where all is reflected.
std::optional<BsdfSample> refract(const Bsdf& pane, Vec3 wo) {
    constexpr float kLast = 0x1.fffffep-1f;  // reflection has the numbers below its share
    const std::optional<BsdfSample> s = sample(pane, wo, kLast, {});
    return s && is_transmission(s->lobe) ? s : std::nullopt;
}

}  // namespace

float density_through_panes(const LitScene& scene, const LitPlace& place, Ray ray, float to_pane,
                            uint64_t& rays) {
    ray.t_max = kInfinity;
    float density = 0, travelled = 0;
    SurfaceHit hit;
    for (int i = 0; i < kMostInterfaces; ++i) {
        ++rays;
        if (!scene.geometry.intersect_behind_panes(ray, hit)) {
            if (!scene.lights.has_environment()) return density;
            const Lights::Sky sky = scene.lights.sky(place.position, place.normal, ray.direction,
                                                     place.sky_cell, RayKind::diffuse);
            return is_black(sky.radiance) ? density : density + sky.pdf;
        }
        travelled += hit.t;
        if (travelled > to_pane && !is_black(scene.lights.emitted(hit, -ray.direction)))
            density += scene.lights.pdf(place.position, place.normal, ray.direction, hit,
                                        place.lamp_factors);
        // Where a mix stands, no sample is followed
        const PlacedShape& shape = scene.geometry.shapes()[hit.shape];
        if (!shape.lets_light_pass && !scene.materials.lets_light_pass(shape.description.material))
            return density;
        ray.origin = Geometry::offset_origin(hit, ray.direction);
    }
    return density;
}

void PathTracer::leave(float mirror_share) {
    if (samples_through_panes_ || samples_by_mirrors_)
        departure_ = {lit_, ray_.origin, ray_.direction, pdf_, 0, 0, -1, mirror_share};
}

void PathTracer::leave_from(const LitPlace& place, float pdf) {
    lit_ = place;
    pdf_ = pdf;
    leave(1);
}

void PathTracer::leave_specular(const SurfaceHit& hit, const PlacedShape& shape,
                                const BsdfSample& s) {
    if (departure_.panes < 0) return;
    departure_.pdf *= s.pdf;
    const bool met_mirror = came_by_mirror();
    if (is_transmission(s.lobe)) {
        if (!samples_through_panes_ || met_mirror || !shape.is_pane)
            departure_.panes = departure_.mirror = -1;
        else if (departure_.panes++ == 0)
            departure_.to_pane = distance(departure_.origin, hit.position);
        return;
    }
    const bool may_be_mirror =
        samples_by_mirrors_ && !met_mirror && departure_.panes == 0 && departure_.mirror_share > 0;
    departure_.mirror = may_be_mirror ? scene_.mirrors.at(hit) : -1;
    if (!came_by_mirror()) departure_.panes = -1;
}

float PathTracer::weight_through_panes() {
    Ray ray;
    ray.origin = departure_.origin;
    ray.direction = departure_.direction;
    ray.time = ray_.time;
    ray.sample = ray_.sample;
    return power_heuristic(departure_.pdf,
                           density_through_panes(scene_, departure_.place, ray, departure_.to_pane,
                                                 result_.rays.shadow));
}

void PathTracer::add_light_through_panes(bool blocked) {
    const SampledLight light = *sampled_light_;
    sampled_light_.reset();
    const uint64_t rays_before = result_.rays.shadow++;
    if (!blocked) follow_through_panes(light);
    result_.rays_through_panes += result_.rays.shadow - rays_before;
}

void PathTracer::follow_through_panes(const SampledLight& light) {
    Ray ray = light.ray;
    ray.direction = light.to_point;
    ray.t_max = kInfinity;
    const Ray straight = ray;
    MediumId medium = light.medium;
    Rgb carried = light.scattered;
    float path_pdf = light.path_pdf;
    int panes = 0;
    float way = 0;      // its length so far
    float to_pane = 0;  // distance of the first one
    float pdf = -1;     // density of the sample, looked for where there is light
    const auto add = [&](Rgb radiance) {
        if (panes == 0 || is_black(radiance)) return;
        if (pdf < 0)
            pdf =
                density_through_panes(scene_, light.place, straight, to_pane, result_.rays.shadow);
        if (!(pdf > 0)) return;
        const Rgb found = carried * radiance;
        const Rgb contribution = found * (power_heuristic(pdf, path_pdf) / pdf);
        // The path alone would find it with the second moment found^2 / path_pdf, both together
        // with about found^2 / (path_pdf + pdf); this sample stands for 1 / pdf of them
        result_.saved_by_panes += sqr(luminance(found)) / (path_pdf * (path_pdf + pdf));
        result_.radiance += contribution;
        if (light.vertex) light.vertex->direct += luminance(contribution);
    };
    SurfaceHit hit;
    for (int i = 0; i < kMostInterfaces && !is_black(carried); ++i) {
        // Find what the way meets, and its light
        ++result_.rays.shadow;
        const bool found = scene_.geometry.intersect(ray, hit);
        carried *= transmittance(scene_, medium, ray, found ? hit.t : kInfinity);
        if (!found) {
            if (scene_.lights.has_environment())
                add(scene_.lights.environment(ray.origin, ray.direction, ray.kind));
            return;
        }
        way += hit.t;
        add(scene_.lights.emitted(hit, -ray.direction, way));
        // Go through it if it is a pane, or if it is not in the way
        const PlacedShape& shape = scene_.geometry.shapes()[hit.shape];
        if (shape.is_pane) {
            if (panes == 0) to_pane = distance(light.ray.origin, hit.position);
            if (depth_ + panes++ == max_depth_) return;
            const MaterialId material = shape.description.material;
            const Frame frame = frame_at(hit, shape, material);
            const auto s = refract(bsdf_at(hit, material), frame.to_local(-ray.direction));
            if (!s) return;
            carried *= s->weight * s->pdf;
            path_pdf *= s->pdf;
            ray.direction = normalize(frame.to_world(s->wi));
            ray.kind = RayKind::transmission;
        } else {
            const float passes = passed_share(scene_, hit);
            if (!(passes > 0)) return;
            carried *= passes;
        }
        medium = medium_beyond(shape, hit, ray.direction, medium);
        ray.origin = Geometry::offset_origin(hit, ray.direction);
    }
}

}  // namespace covtrace
