/// The opacity of what the camera's ray meets straight on: surfaces that stand in its way, and the
/// extinction of media up to holdouts, or to where there is no sky.
#include "integrator/path_tracer.h"

namespace covtrace {

void PathTracer::tell_clear() {
    result_.opacity = 1 - (clear_.r + clear_.g + clear_.b) / 3;
}

void PathTracer::end_at_holdout() {
    tell_clear();
    if (!record_) return;
    const Vec3 last = record_->count > 0
                          ? record_->vertices[size_t(record_->count - 1)].hit.position
                          : record_->camera_ray.origin;
    record_last_way(distance(last, hit_.position));
}

void PathTracer::tell_opacity_of_sky() {
    if (scene_.lights.has_sky_for(RayKind::camera))
        result_.opacity = 1;
    else
        tell_clear();
}

float PathTracer::passed_to_camera(const PlacedShape& shape, const SurfaceHit& hit) const {
    if (shape.lets_light_pass || is_unseen_back(shape, hit, ray_.direction)) return 1;
    const PlacedMaterial material =
        scene_.materials.at(shape.description.material, hit, scene_.textures);
    const Bsdf bsdf = bsdf_at(hit, material.id);
    const auto* unlit = std::get_if<UnlitBsdf>(&bsdf);
    const bool passes = unlit ? !is_seen(*unlit, hit) : std::holds_alternative<InterfaceBsdf>(bsdf);
    return passes ? material.weight : 0;
}

void PathTracer::tell_opacity_behind(bool found) {
    Ray ray = ray_;
    SurfaceHit hit = hit_;
    MediumId medium = medium_;
    for (int i = passed_interfaces_; found && i <= kMostInterfaces; ++i) {
        const PlacedShape& shape = scene_.geometry.shapes()[hit.shape];
        const float passed = passed_to_camera(shape, hit);
        if (!(passed > 0)) {
            if (shape.description.is_holdout)
                tell_clear();
            else
                result_.opacity = 1;
            return;
        }
        clear_ *= passed;
        medium = medium_beyond(shape, hit, ray.direction, medium);
        ray.origin = Geometry::offset_origin(hit, ray.direction);
        ++result_.rays.camera;
        found = scene_.geometry.intersect(ray, hit);
        if (medium >= 0 && finds(medium))
            clear_ *= transmittance(scene_, medium, ray, found ? hit.t : kInfinity);
    }
    if (found)
        result_.opacity = 1;  // caught between interfaces
    else
        tell_opacity_of_sky();
}

}  // namespace covtrace
