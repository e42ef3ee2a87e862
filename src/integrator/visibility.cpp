#include "integrator/visibility.h"

#include <cmath>

namespace covtrace {

MediumId medium_beyond(const PlacedShape& shape, const SurfaceHit& hit, Vec3 w, MediumId current) {
    const ShapeDescription& d = shape.description;
    if (d.inside == d.outside) return current;
    return dot(w, hit.ng) < 0 ? d.inside : d.outside;
}

Rgb transmittance(const LitScene& scene, MediumId medium, float distance) {
    if (medium < 0) return Rgb(1);
    return transmittance(scene.media[static_cast<size_t>(medium)],
                         std::isfinite(distance) ? distance : scene.unbounded_distance);
}

Rgb visibility(const LitScene& scene, Ray ray, float distance, MediumId medium, uint64_t& rays) {
    if (!scene.has_interfaces) return transmittance(scene, medium, distance);
    // Walk through the rest of the way: it holds only what lets light pass, and mixes that are
    // interfaces in places
    Rgb passes(1);
    SurfaceHit hit;
    ray.kind = RayKind::shadow;
    for (int i = 0; i < kMostInterfaces; ++i) {
        ++rays;
        if (!(ray.t_max > 0) || !scene.geometry.intersect(ray, hit)) break;
        const PlacedShape& shape = scene.geometry.shapes()[hit.shape];
        const MaterialId material =
            scene.materials.at(shape.description.material, hit, scene.textures);
        if (!scene.materials.lets_light_pass(material)) {
            if (material != shape.description.material) return Rgb(0);
            break;
        }
        passes *= transmittance(scene, medium, hit.t);
        medium = medium_beyond(shape, hit, ray.direction, medium);
        ray.origin = Geometry::offset_origin(hit, ray.direction);
        ray.t_max -= hit.t;
        distance -= hit.t;
    }
    return passes * transmittance(scene, medium, std::max(distance, 0.0f));
}

bool is_met(const LitScene& scene, Ray ray, uint64_t& rays) {
    SurfaceHit hit;
    for (int i = 0; i < kMostInterfaces; ++i) {
        ++rays;
        if (!(ray.t_max > 0) || !scene.geometry.intersect(ray, hit)) return false;
        const PlacedShape& shape = scene.geometry.shapes()[hit.shape];
        if (!shape.lets_light_pass && !scene.materials.lets_light_pass(scene.materials.at(
                                          shape.description.material, hit, scene.textures)))
            return true;
        ray.origin = Geometry::offset_origin(hit, ray.direction);
        ray.t_max -= hit.t;
    }
    return true;
}

}  // namespace covtrace
