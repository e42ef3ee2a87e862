#include "integrator/visibility.h"

#include <cmath>

#include "geometry/leave_surface.h"

namespace covtrace {

namespace {

/// Share of the way to a light that rays leave out at its end: sixteen roundings, of which their
/// lengths, their directions' lengths and Embree's distances suffer about eight. A larger share
/// lets light out of the housings of distant lamps.
constexpr float kLeftOut = 1e-6f;

}  // namespace

float aim(Ray& ray, Vec3 target) {
    const Vec3 way = target - ray.origin;
    const float distance = length(way);
    if (!(distance > 0)) return 0;
    ray.direction = way / distance;
    ray.t_max = distance * (1 - kLeftOut);
    return distance;
}

float aim(Ray& ray, const LightSample& light) {
    if (std::isfinite(light.distance)) return aim(ray, light.position);
    ray.direction = light.wi;
    ray.t_max = kInfinity;
    return kInfinity;
}

float passed_share(const LitScene& scene, const SurfaceHit& hit) {
    const PlacedShape& shape = scene.geometry.shapes()[hit.shape];
    if (shape.lets_light_pass) return 1;
    const PlacedMaterial material =
        scene.materials.at(shape.description.material, hit, scene.textures);
    return scene.materials.lets_light_pass(material.id) ? material.weight : 0;
}

MediumId medium_beyond(const PlacedShape& shape, const SurfaceHit& hit, Vec3 w, MediumId current) {
    const ShapeDescription& d = shape.description;
    if (d.inside == d.outside) return current;
    return dot(w, hit.ng) < 0 ? d.inside : d.outside;
}

Rgb transmittance(const LitScene& scene, MediumId medium, const Ray& ray, float distance) {
    if (medium < 0) return Rgb(1);
    const Medium& m = scene.media[static_cast<size_t>(medium)];
    const MediumWay way(m, ray.origin, ray.direction);
    return transmittance(m,
                         way.column(std::isfinite(distance) ? distance : scene.unbounded_distance));
}

Rgb visibility(const LitScene& scene, Ray ray, float distance, MediumId medium, uint64_t& rays) {
    if (!scene.has_interfaces) return transmittance(scene, medium, ray, distance);
    // Walk through the rest of the way: it holds only what lets light pass, and mixes that are
    // interfaces in places
    const Vec3 end = end_of(ray);
    Rgb passes(1);
    SurfaceHit hit;
    ray.kind = RayKind::shadow;
    for (int i = 0; i < kMostInterfaces; ++i) {
        ++rays;
        if (!(ray.t_max > 0) || !scene.geometry.intersect(ray, hit)) break;
        const PlacedShape& shape = scene.geometry.shapes()[hit.shape];
        const PlacedMaterial material =
            scene.materials.at(shape.description.material, hit, scene.textures);
        if (!scene.materials.lets_light_pass(material.id)) {
            if (material.id != shape.description.material) return Rgb(0);
            break;
        }
        passes *= material.weight * transmittance(scene, medium, ray, hit.t);
        medium = medium_beyond(shape, hit, ray.direction, medium);
        distance -= go_on_behind(hit, end, ray);
    }
    return passes * transmittance(scene, medium, ray, std::max(distance, 0.0f));
}

bool is_met(const LitScene& scene, Ray ray, uint64_t& rays) {
    const Vec3 end = end_of(ray);
    SurfaceHit hit;
    for (int i = 0; i < kMostInterfaces; ++i) {
        ++rays;
        if (!(ray.t_max > 0) || !scene.geometry.intersect(ray, hit)) return false;
        if (!(passed_share(scene, hit) > 0)) return true;
        go_on_behind(hit, end, ray);
    }
    return true;
}

}  // namespace covtrace
