#include "laboratory/sensor_rays.h"

#include <algorithm>

namespace covtrace {

namespace {
constexpr float kMiddle = 0.5f;  // middle of the shutter, and of the lens in both coordinates
}

SensorRays::SensorRays(const RenderScene& scene, Vec2 film) : scene_(scene), film_(film) {}

Ray SensorRays::operator()(const SensorOffset& offset) const {
    const Vec2 film{film_.x + float(offset[0]), film_.y + float(offset[1])};
    Ray ray = scene_.camera.generate_ray(film, {kMiddle, kMiddle}, kMiddle + float(offset[4]));
    const SensorGeometry g = scene_.camera.sensor(ray);
    if (!(g.lens_radius > 0)) return ray;
    const Vec3 focus =
        ray.origin + ray.direction * (g.focal_distance / dot(ray.direction, g.forward));
    ray.origin +=
        g.right * (g.lens_radius * float(offset[2])) + g.down * (g.lens_radius * float(offset[3]));
    ray.direction = normalize(focus - ray.origin);
    return ray;
}

std::array<bool, 5> sensor_axes(const RenderScene& scene) {
    const SceneDescription& d = scene.description;
    const auto& shapes = scene.geometry.shapes();
    const bool moves =
        d.camera.camera_to_world.is_animated() ||
        std::any_of(
            shapes.begin(), shapes.end(),
            [](const PlacedShape& s) { return s.description.object_to_world.is_animated(); }) ||
        std::any_of(d.instances.begin(), d.instances.end(),
                    [](const InstanceDescription& i) { return i.instance_to_world.is_animated(); });
    const bool lens = scene.camera.has_lens();
    return {true, true, lens, lens, moves};
}

}  // namespace covtrace
