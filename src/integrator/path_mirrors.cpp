/// Light by flat mirrors: sampled, and found by the path itself.
#include <algorithm>
#include <cmath>

#include "integrator/mirrored_light.h"
#include "integrator/path_tracer.h"

namespace covtrace {

namespace {

/// Throughput below which a light is sampled by a mirror in some of the places alone, as little
/// depends on it: what the path finds by itself counts for more there.
constexpr float kWorthwhile = 0.5f;

/// The place on a mirror as a vertex that reflects a sampled light towards `wo`.
PathVertex vertex_on_mirror(const SurfaceHit& hit, MaterialId material, const Frame& frame, Vec3 wo,
                            const BsdfSample& reflected, const LightSample& light) {
    PathVertex place;
    place.hit = hit;
    place.wo = wo;
    place.shading = frame;
    place.material = material;
    place.light = light;
    place.direct_event.wi = light.wi;
    place.direct_event.lobes.count = 1;
    place.direct_event.lobes.lobes[0] = {reflected.lobe, reflected.weight, 0, 0, reflected.eta};
    return place;
}

}  // namespace

float density_by_mirror(const LitScene& scene, int mirror, const LitPlace& place, Vec3 to_light,
                        const SurfaceHit* hit) {
    const MirroredPlace image(scene.mirrors[mirror], place);
    const float pdf = hit ? scene.lights.pdf(image.position, image.normal, to_light, *hit)
                          : scene.lights.sky(image.position, image.normal, to_light).pdf;
    return pdf * scene.mirrors.probability(mirror, place.position, place.normal);
}

bool PathTracer::find_mirror(int mirror, Ray ray, SurfaceHit& hit, MediumId& medium, Rgb& passes) {
    for (int i = 0; i < kMostInterfaces; ++i) {
        ++result_.rays.shadow;
        if (!scene_.geometry.intersect(ray, hit)) return false;
        passes *= transmittance(scene_, medium, ray, hit.t);
        if (scene_.mirrors.at(hit) == mirror) return true;
        const float share = passed_share(scene_, hit);
        if (!(share > 0)) return false;
        passes *= share;
        const PlacedShape& shape = scene_.geometry.shapes()[hit.shape];
        medium = medium_beyond(shape, hit, ray.direction, medium);
        ray.origin = Geometry::offset_origin(hit, ray.direction);
    }
    return false;
}

void PathTracer::add_mirrored_light(const Surface& surface, PathVertex* vertex) {
    // Choose a mirror, unless too little depends on it
    mirror_share_ = std::min(1.0f, max_component(beta_) * roulette_scale_ / kWorthwhile);
    const uint32_t pairs = kMirrorPairs + static_cast<uint32_t>(depth_) * 2;
    Vec2 u_choice = sampler_.pair(pairs);
    const auto chosen = scene_.mirrors.choose(lit_.position, lit_.normal, u_choice.x);
    if (!chosen || !(u_choice.x < mirror_share_)) return;
    const FlatMirror& mirror = scene_.mirrors[chosen->mirror];
    const uint64_t rays_before = result_.rays.shadow;
    ++result_.samples_by_mirrors;
    // Sample a light as the place's image sees it
    const MirroredPlace image(mirror, lit_);
    const auto light = scene_.lights.sample(image.position, image.normal, surface.hit.time,
                                            u_choice.y, sampler_.pair(pairs + 1));
    if (!light || light->is_delta || is_black(light->radiance) || !(light->pdf > 0)) return;
    const Vec3 wi = mirror.reflect_direction(light->wi);
    const auto to_mirror = mirror.crossing(lit_.position, wi);
    if (!to_mirror || !(*to_mirror < light->distance)) return;
    const Vec3 wi_local = surface.frame.to_local(wi);
    const BsdfValue value = eval_direction(surface, wi_local, wi);
    if (is_black(value.f)) return;
    // Find the mirror
    Ray ray;
    ray.origin = Geometry::offset_origin(surface.hit, wi);
    ray.direction = wi;
    ray.time = surface.hit.time;
    ray.sample = surface.hit.sample;
    ray.kind = RayKind::diffuse;
    MediumId medium = medium_beyond(surface.shape, surface.hit, wi, medium_);
    Rgb carried = beta_ * value.f;
    SurfaceHit hit;
    const bool found = find_mirror(chosen->mirror, ray, hit, medium, carried);
    result_.rays_by_mirrors += result_.rays.shadow - rays_before;
    if (!found) return;
    const PlacedShape& shape = scene_.geometry.shapes()[hit.shape];
    const MaterialId material = shape.description.material;
    const Bsdf bsdf = bsdf_at(hit, material);
    const Frame frame = reflecting_frame(frame_at(hit, shape, material), hit, bsdf, -wi);
    const auto reflected = sample(bsdf, frame.to_local(-wi), 0, {});
    if (!reflected || !is_specular(reflected->lobe) || is_transmission(reflected->lobe)) return;
    carried *= reflected->weight * reflected->pdf;
    // Look at the light from there
    Ray shadow;
    shadow.origin = Geometry::offset_origin(hit, light->wi);
    shadow.time = ray.time;
    shadow.sample = ray.sample;
    shadow.kind = RayKind::glossy;
    medium = medium_beyond(shape, hit, light->wi, medium);
    const float distance = aim(shadow, *light);
    if (!(distance > 0)) return;
    const Rgb radiance = std::isfinite(distance)
                             ? light->radiance
                             : scene_.lights.environment(shadow.origin, light->wi, shadow.kind);
    ++result_.rays.shadow;
    ++result_.rays_by_mirrors;
    if (scene_.geometry.occluded(shadow)) return;
    carried *= radiance * visibility(scene_, shadow, distance, medium, result_.rays.shadow);
    const float pdf = mirror_share_ * chosen->probability * light->pdf;
    const float path_pdf = value.pdf * reflected->pdf;
    const Rgb contribution = carried * (power_heuristic(pdf, path_pdf) / pdf);
    result_.radiance += contribution;
    // As at panes: the path alone has the second moment carried^2 / path_pdf
    if (path_pdf > 0)
        result_.saved_by_mirrors += sqr(luminance(carried)) / (path_pdf * (path_pdf + pdf));
    if (!vertex) return;
    // Record it
    vertex->mirrored = luminance(contribution);
    vertex->mirrored_event = {wi, lobe_shares(surface.bsdf, surface.wo, wi_local, value.f)};
    const auto index = size_t(vertex - record_->vertices.data());
    LightSample seen = *light;
    seen.wi = shadow.direction;
    seen.distance = distance;
    record_->mirrors[index] = vertex_on_mirror(hit, material, frame, -wi, *reflected, seen);
    record_->mirrors[index].direct = vertex->mirrored;
}

float PathTracer::weight_by_mirror(const SurfaceHit* hit) const {
    const float pdf =
        density_by_mirror(scene_, departure_.mirror, departure_.place, ray_.direction, hit);
    return power_heuristic(departure_.pdf, departure_.mirror_share * pdf);
}

}  // namespace covtrace
