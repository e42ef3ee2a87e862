#include "integrator/view_probe.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "core/frame.h"
#include "core/sampler.h"
#include "core/warp.h"
#include "image/color_encoding.h"
#include "integrator/visibility.h"
#include "light/lights.h"
#include "scene/imaging_scale.h"

namespace covtrace {

namespace {

constexpr int kMostPassed = 64;  // backs, or surfaces of glass, that a ray passes
/// Share of what the camera sees that some light from outside must reach (decision 0120).
constexpr float kLeastReached = 0.5f;
constexpr int kSkyRays = 8;  // per place that is seen
/// Value in the image of what glows as the sky does: that below the horizon (scene/defaults.cpp).
constexpr float kGlow = 0.1f;
constexpr uint32_t kPaths = 32;       // per place that is seen, which look for lamps
constexpr int kMostMet = 8;           // surfaces that such a path meets
constexpr float kLeastPassed = 0.5f;  // share of light that what is no wall to it lets through

/// Whether light passes surfaces of a material: borders of media, and what is seen but throws no
/// shadow.
bool lets_light_pass(const MaterialDescription& material) {
    return std::holds_alternative<InterfaceMaterial>(material.value) ||
           std::holds_alternative<UnlitMaterial>(material.value);
}

TexturePoint place_on(const SurfaceHit& hit) {
    return {hit.uv, hit.position, {}, hit.ng, hit.vertices(), hit.facing};
}

/// The ray to light outside, from a hit.
Ray ray_outside(const SurfaceHit& hit, Vec3 direction) {
    Ray ray{Geometry::offset_origin(hit, direction), direction, hit.time};
    ray.kind = RayKind::shadow;
    return ray;
}

}  // namespace

ViewProbe::ViewProbe(const SceneDescription& scene, const Geometry& geometry,
                     const TextureStore& textures)
    : scene_(scene),
      geometry_(geometry),
      textures_(textures),
      camera_(scene.camera, scene.film.width, scene.film.height) {}

Ray ViewProbe::view_ray(float x, float y) const {
    Ray ray = camera_.generate_ray({x * float(scene_.film.width), y * float(scene_.film.height)},
                                   {0.5f, 0.5f}, 0);
    ray.kind = RayKind::camera;
    return ray;
}

bool ViewProbe::follow(Ray ray, SurfaceHit& hit, Vec3* passed) const {
    for (int i = 0; i < kMostPassed; ++i) {
        // A camera on the plane of a wall does not see it
        const bool is_first = i == 0 && ray.kind == RayKind::camera;
        if (!(is_first ? geometry_.intersect_seen(ray, hit) : geometry_.intersect(ray, hit)))
            return false;
        const PlacedShape& shape = geometry_.shapes()[hit.shape];
        const bool is_back = is_unseen_back(shape, hit, ray.direction);
        const MaterialId material = shape.description.material;
        if (!shape.lets_light_pass && !is_back &&
            (material < 0 || !lets_light_pass(scene_.materials[static_cast<size_t>(material)])))
            return true;
        ray.origin = Geometry::offset_origin(hit, ray.direction);
        if (passed && is_back) *passed = ray.origin;
    }
    return false;
}

/// Whether a surface glows in the direction w away from it, for the camera and for others. Files
/// whose surfaces glow by up to 1 get the lights that stand in, too.
bool ViewProbe::glows(const SurfaceHit& hit, Vec3 w) const {
    const int index = geometry_.shapes()[hit.shape].description.area_light;
    if (index < 0) return false;
    const AreaLightDescription& light = scene_.area_lights[static_cast<size_t>(index)];
    if (!light.two_sided && !(dot(hit.ng, w) > 0)) return false;
    Rgb radiance = light.radiance * imaging_scale(scene_);
    if (light.image >= 0) radiance *= textures_.eval(light.image, place_on(hit));
    return max_component(radiance) >= kGlow;
}

/// Whether most light gets through a surface: through glass, straight or not, of which paths leave
/// bodies again, and through cloth. Of a mix the larger part decides.
bool ViewProbe::is_passed(MaterialId id, const SurfaceHit& hit) const {
    const TexturePoint at = place_on(hit);
    while (id >= 0 && scene_.materials[static_cast<size_t>(id)].mix) {
        const MaterialMix& mix = *scene_.materials[static_cast<size_t>(id)].mix;
        id = mix.materials[textures_.eval_float(mix.amount, at) > kLeastPassed ? 1 : 0];
    }
    if (id < 0) return false;
    const MaterialDescription& material = scene_.materials[static_cast<size_t>(id)];
    const auto& value = material.value;
    if (const auto* cloth = std::get_if<DiffuseTransmissionMaterial>(&value))
        return cloth->transmittance >= 0 &&
               cloth->scale * max_component(textures_.eval(cloth->transmittance, at)) >=
                   kLeastPassed;
    return lets_light_pass(material) || std::holds_alternative<ThinDielectricMaterial>(value) ||
           std::holds_alternative<DielectricMaterial>(value);
}

bool ViewProbe::keeps_light(const SurfaceHit& hit) const {
    const PlacedShape& shape = geometry_.shapes()[hit.shape];
    return !shape.lets_light_pass && !is_passed(shape.description.material, hit);
}

bool ViewProbe::meet(Ray ray, SurfaceHit& hit) const {
    for (int i = 0; i < kMostPassed; ++i) {
        if (!geometry_.intersect(ray, hit)) return false;
        if (keeps_light(hit)) return true;
        ray.t_max -= hit.t;
        ray.origin = Geometry::offset_origin(hit, ray.direction);
    }
    return false;
}

/// Whether a ray from a hit leaves the scene, through what lets most light pass as well, or meets
/// what glows.
bool ViewProbe::finds_light(const SurfaceHit& hit, Vec3 direction,
                            const std::vector<bool>& open) const {
    Ray ray = ray_outside(hit, direction);
    SurfaceHit met;
    for (int i = 0; i < kMostPassed && meet(ray, met); ++i) {
        if (glows(met, -direction)) return true;
        if (open.empty() || !open[met.shape]) return false;
        ray.origin = Geometry::offset_origin(met, direction);
    }
    return true;
}

/// Whether light reaches a hit that is seen along `view`, where `finds(direction)` tells whether
/// there is any in a direction: in those of distant lights and in some of the sky.
template <typename Finds>
bool ViewProbe::is_reached(const SurfaceHit& hit, Vec3 view, const Finds& finds) const {
    for (const LightDescription& light : scene_.lights)
        if (const auto* distant = std::get_if<DistantLight>(&light.value)) {
            const Vec3 direction = light.light_to_world.vector(distant->direction);
            if (dot(hit.ng, view) * dot(hit.ng, direction) < 0 && finds(direction)) return true;
        }
    const Frame frame = Frame::from_z(face_forward(hit.ng, -view));
    for (int i = 0; i < kSkyRays; ++i) {
        constexpr float kGolden = 0.61803399f;  // spreads azimuths evenly
        const float turn = (float(i) + 0.5f) * kGolden;
        const Vec2 u{(float(i) + 0.5f) / kSkyRays, turn - std::floor(turn)};
        if (finds(frame.to_world(square_to_cosine_hemisphere(u)))) return true;
    }
    return false;
}

/// Visits what is seen: `visit(hit, view)`.
template <typename Visit>
void ViewProbe::for_all_seen(const Visit& visit) const {
    for_all([&](float x, float y) {
        const Ray view = view_ray(x, y);
        SurfaceHit hit;
        if (follow(view, hit)) visit(hit, view.direction);
    });
}

bool ViewProbe::is_dark(const std::vector<bool>& open) const {
    int seen = 0, reached = 0;
    for_all_seen([&](const SurfaceHit& hit, Vec3 view) {
        ++seen;
        reached += glows(hit, -view) ||
                   is_reached(hit, view, [&](Vec3 w) { return finds_light(hit, w, open); });
    });
    return seen > 0 && float(reached) < kLeastReached * float(seen);
}

/// The value in the image of a white surface that is seen along `view` where one path finds light:
/// by a lamp at each of the surfaces that it meets, all of which count as white.
float ViewProbe::light_at(const SurfaceHit& seen, Vec3 view, const Lights& lights,
                          Sampler& sampler) const {
    float sum = 0;
    SurfaceHit hit = seen;
    Vec3 direction = view;
    for (int i = 0; i < std::min(scene_.max_depth, kMostMet); ++i) {
        const Vec3 normal = face_forward(hit.ng, -direction);
        const float u_light = sampler.next_1d();
        const auto light =
            lights.sample(hit.position, normal, hit.time, u_light, sampler.next_2d());
        const float cosine = light ? dot(normal, light->wi) : 0;
        if (cosine > 0 && light->pdf > 0) {
            const Vec3 origin = Geometry::offset_origin(hit, light->wi);
            Ray shadow{origin, light->wi, hit.time};
            shadow.kind = RayKind::shadow;
            constexpr float kBefore = 0.999f;  // the lamp itself is no wall
            if (light->distance < kInfinity)
                shadow.t_max = kBefore * length(light->position - origin);
            SurfaceHit met;
            if (!meet(shadow, met)) sum += luminance(light->radiance) * cosine / (light->pdf * kPi);
        }
        direction = Frame::from_z(normal).to_world(square_to_cosine_hemisphere(sampler.next_2d()));
        Ray ray{Geometry::offset_origin(hit, direction), direction, hit.time};
        ray.kind = RayKind::diffuse;
        if (!meet(ray, hit)) break;
    }
    return sum * imaging_scale(scene_);
}

/// Whether lamps reach a hit that is seen along `view`. `place`: its number among those of the
/// view.
bool ViewProbe::is_lit(const SurfaceHit& hit, Vec3 view, const Lights& lights, int place) const {
    const float least = float(kPaths) * srgb_decode(1.0f / 255);
    float sum = 0;
    for (uint32_t path = 0; path < kPaths && sum < least; ++path) {
        Sampler sampler(0, place % kSide, place / kSide, path);
        const float value = light_at(hit, view, lights, sampler);
        if (std::isfinite(value)) sum += value;
    }
    return sum >= least;
}

bool ViewProbe::is_dark(const Lights& lights) const {
    int seen = 0, lit = 0;
    for_all_seen([&](const SurfaceHit& hit, Vec3 view) {
        if (glows(hit, -view)) return;
        lit += is_lit(hit, view, lights, seen++);
    });
    return seen > 0 && float(lit) < kLeastReached * float(seen);
}

std::vector<bool> ViewProbe::outer_walls() const {
    const size_t count = geometry_.shapes().size();
    std::vector<int> met(count), last(count);
    for_all_seen([&](const SurfaceHit& seen, Vec3 view) {
        // No way is called open, so that all of them are walked
        is_reached(seen, view, [&](Vec3 direction) {
            Ray ray = ray_outside(seen, direction);
            std::vector<uint32_t> way;
            SurfaceHit hit;
            for (int i = 0; i < kMostPassed && meet(ray, hit); ++i) {
                if (std::find(way.begin(), way.end(), hit.shape) == way.end()) ++met[hit.shape];
                way.push_back(hit.shape);
                ray.origin = Geometry::offset_origin(hit, direction);
            }
            if (!way.empty()) ++last[way.back()];
            return false;
        });
    });
    std::vector<bool> walls(count);
    for (size_t i = 0; i < count; ++i) {
        const ShapeDescription& shape = geometry_.shapes()[i].description;
        walls[i] = last[i] > 0 && 2 * last[i] >= met[i] && shape.area_light < 0 &&
                   shape.inside < 0 && shape.outside < 0;
    }
    return walls;
}

}  // namespace covtrace
