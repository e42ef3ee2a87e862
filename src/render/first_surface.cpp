#include "render/first_surface.h"

#include <cmath>

namespace covtrace {

namespace {

/// Way along the tangent plane from the position to where another ray meets it.
Vec3 way_to(const Ray& ray, const PathResult& path) {
    const float towards = dot(ray.direction, path.geometric_normal);
    const float t = dot(path.position - ray.origin, path.geometric_normal) / towards;
    return ray.origin + ray.direction * t - path.position;
}

Vec3 finite(Vec3 v) {
    return is_finite(v) ? v : Vec3{};
}
Vec2 finite(Vec2 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) ? v : Vec2{};
}

}  // namespace

void FirstSurface::approach(const FirstSurface& other, float share) {
    const auto step = [share](auto& value, auto target) {
        value = value + (target - value) * share;
    };
    step(position, other.position);
    step(geometric_normal, other.geometric_normal);
    step(normal, other.normal);
    step(uv, other.uv);
    step(slope, other.slope);
}

FirstSurface first_surface(const RenderScene& scene, FilmDescription::Surfaces space,
                           const Ray& ray, const std::array<Ray, 2>& beside,
                           const PathResult& path) {
    Transform from_world;
    if (space == FilmDescription::Surfaces::camera)
        from_world = scene.description.camera.camera_to_world.at(ray.time).inverse();
    FirstSurface s;
    s.position = finite(from_world.point(path.position));
    s.geometric_normal = finite(normalize(from_world.normal(path.geometric_normal)));
    s.normal = finite(normalize(from_world.normal(path.normal)));
    s.uv = finite(path.uv);
    if (path.geometric_normal != Vec3{})
        s.slope = finite(Vec2{from_world.vector(way_to(beside[0], path)).z,
                              from_world.vector(way_to(beside[1], path)).z});
    return s;
}

}  // namespace covtrace
