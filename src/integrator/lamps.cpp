#include "integrator/lamps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>
#include <vector>

#include "camera/camera.h"
#include "core/frame.h"
#include "core/sampler.h"
#include "core/warp.h"
#include "integrator/visibility.h"
#include "scene/added_lamps.h"
#include "scene/imaging_scale.h"
#include "shading/material.h"

namespace covtrace {

namespace {

constexpr int kSide = 24;        // rays per side of the picture, or of all directions
constexpr int kMostPassed = 64;  // backs, or surfaces of glass, that a ray passes
/// Value of a white surface in the direct light of all lamps, where that is more than in so large a
/// share of what is seen. The rest, near the lamp, may be brighter.
constexpr float kGoal = 0.6f, kBrighterThan = 0.75f;
/// Value of a white surface with the light that others send on, where that is more than as much
/// again: in white rooms and near a wall behind the lamp.
constexpr float kGoalWithOthers = 1.2f;
constexpr uint32_t kPaths = 8;     // per place, that look for light which others send on
constexpr int kMostSent = 8;       // surfaces that such a path meets
constexpr float kLeastLit = 0.1f;  // share of the rays by which a lamp has to be seen to light
/// Share of what the camera sees that some light from outside must reach, or a lamp stands there,
/// too: as much as makes the program tell of a dark image (image/darkness.h, decision 0120).
constexpr float kLeastReached = 0.5f;
constexpr int kSkyRays = 8;  // per place that is seen
/// Value in the image of what glows as the sky does: that below the horizon (scene/defaults.cpp).
constexpr float kGlow = 0.1f;
constexpr float kLeastPassed = 0.5f;  // share of light that what is no wall to it lets through

/// Whether light passes surfaces of a material: borders of media, and what is seen but throws no
/// shadow.
bool lets_light_pass(const MaterialDescription& material) {
    return std::holds_alternative<InterfaceMaterial>(material.value) ||
           std::holds_alternative<UnlitMaterial>(material.value);
}

/// Follows a ray past surfaces that it does not see. `passed`: the place of the last back.
bool follow(const SceneDescription& scene, const Geometry& geometry, Ray ray, SurfaceHit& hit,
            Vec3* passed = nullptr) {
    for (int i = 0; i < kMostPassed; ++i) {
        // A camera on the plane of a wall does not see it
        const bool is_first = i == 0 && ray.kind == RayKind::camera;
        if (!(is_first ? geometry.intersect_seen(ray, hit) : geometry.intersect(ray, hit)))
            return false;
        const PlacedShape& shape = geometry.shapes()[hit.shape];
        const bool is_back = is_unseen_back(shape, hit, ray.direction);
        const MaterialId material = shape.description.material;
        if (!shape.lets_light_pass && !is_back &&
            (material < 0 || !lets_light_pass(scene.materials[static_cast<size_t>(material)])))
            return true;
        ray.origin = Geometry::offset_origin(hit, ray.direction);
        if (passed && is_back) *passed = ray.origin;
    }
    return false;
}

TexturePoint place_on(const SurfaceHit& hit) {
    return {hit.uv, hit.position, {}, {}, hit.vertices()};
}

/// Lamps of one scene.
class Lamps {
  public:
    Lamps(SceneDescription& scene, const Geometry& geometry, const TextureStore& textures)
        : scene_(scene),
          geometry_(geometry),
          textures_(textures),
          camera_(scene.camera, scene.film.width, scene.film.height) {}

    void stand() {
        std::erase_if(scene_.lamps,
                      [&](const LampDescription& l) { return l.is_for_the_dark && !is_dark(); });
        const auto open = std::count_if(scene_.lamps.begin(), scene_.lamps.end(),
                                        [](const LampDescription& l) { return !l.power; });
        for (LampDescription& lamp : scene_.lamps) {
            const Vec3 place = lamp.at ? *lamp.at : beside_camera();
            if (!lamp.power) {
                lamp.power = power_at(place) / static_cast<float>(open);
                tell(lamp, place);
            }
            light(lamp, place);
        }
        scene_.lamps.clear();
    }

  private:
    Ray view_ray(float x, float y) const {
        Ray ray = camera_.generate_ray(
            {x * float(scene_.film.width), y * float(scene_.film.height)}, {0.5f, 0.5f}, 0);
        ray.kind = RayKind::camera;
        return ray;
    }

    Vec3 beside_camera() const {
        const Ray ray = view_ray(0.5f, 0.5f);
        Vec3 place = ray.origin;
        SurfaceHit hit;
        follow(scene_, geometry_, ray, hit, &place);
        return place;
    }

    /// The irradiance of a hit by a point light of intensity 1; 0 where something is between.
    float irradiance(const SurfaceHit& hit, Vec3 place) const {
        const Vec3 away = place - hit.position;
        const float distance = length(away);
        if (!(distance > 0)) return 0;
        Ray shadow{Geometry::offset_origin(hit, away), away / distance, hit.time};
        shadow.t_max = 0.999f * distance;
        shadow.kind = RayKind::shadow;
        if (geometry_.occluded(shadow)) return 0;
        return std::abs(dot(hit.ng, away)) / (distance * distance * distance);
    }

    /// Whether a surface glows in the direction w away from it, for the camera and for others.
    /// Files whose surfaces glow by up to 1 get the lights that stand in, too.
    bool glows(const SurfaceHit& hit, Vec3 w) const {
        const int index = geometry_.shapes()[hit.shape].description.area_light;
        if (index < 0) return false;
        const AreaLightDescription& light = scene_.area_lights[static_cast<size_t>(index)];
        if (!light.two_sided && !(dot(hit.ng, w) > 0)) return false;
        Rgb radiance = light.radiance * imaging_scale(scene_);
        if (light.image >= 0) radiance *= textures_.eval(light.image, place_on(hit));
        return max_component(radiance) >= kGlow;
    }

    /// Whether most light gets through a surface: through glass, straight or not, of which paths
    /// leave bodies again, and through cloth. Of a mix the larger part decides.
    bool is_passed(MaterialId id, const TexturePoint& at) const {
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

    /// Finds the nearest surface that keeps light.
    bool meet(Ray ray, SurfaceHit& hit) const {
        for (int i = 0; i < kMostPassed; ++i) {
            if (!geometry_.intersect(ray, hit)) return false;
            const PlacedShape& shape = geometry_.shapes()[hit.shape];
            if (!shape.lets_light_pass && !is_passed(shape.description.material, place_on(hit)))
                return true;
            ray.origin = Geometry::offset_origin(hit, ray.direction);
        }
        return false;
    }

    /// The share of light that a surface sends back to where `view` comes from.
    float albedo_of(const SurfaceHit& hit, Vec3 view) const {
        const MaterialId id = geometry_.shapes()[hit.shape].description.material;
        const PlacedMaterial material = materials_->at(id, hit, textures_);
        const Vec3 wo = shading_frame(hit).to_local(-view);
        const Bsdf bsdf = materials_->bsdf(material.id, hit, textures_);
        const float share = material.weight * luminance(albedo(bsdf, wo));
        return std::isfinite(share) ? clamp01(share) : 0;
    }

    /// The irradiance of a hit that is seen along `view`, by a lamp of intensity 1, by way of other
    /// surfaces, which count as Lambertian: the mean over paths of the place with that number.
    float irradiance_by_others(const SurfaceHit& seen, Vec3 view, Vec3 lamp, int number) const {
        double sum = 0;
        for (uint32_t path = 0; path < kPaths; ++path) {
            Sampler sampler(0, number % kSide, number / kSide, path);
            SurfaceHit hit = seen;
            Vec3 direction = view;
            float share = 1;
            for (int i = 1; i < std::min(scene_.max_depth, kMostSent) && share > 0; ++i) {
                const Frame frame = Frame::from_z(face_forward(hit.ng, -direction));
                direction = frame.to_world(square_to_cosine_hemisphere(sampler.next_2d()));
                Ray ray{Geometry::offset_origin(hit, direction), direction, hit.time};
                ray.kind = RayKind::diffuse;
                if (!meet(ray, hit)) break;
                share *= albedo_of(hit, direction);
                if (dot(hit.ng, direction) * dot(hit.ng, lamp - hit.position) < 0)
                    sum += share * irradiance(hit, lamp);
            }
        }
        return float(sum / kPaths);
    }

    /// Whether a ray from a hit that is seen along `view` leaves the scene, through what lets most
    /// light pass as well, or meets what glows.
    bool finds_light(const SurfaceHit& hit, Vec3 view, Vec3 direction) const {
        if (dot(hit.ng, view) * dot(hit.ng, direction) >= 0) return false;
        Ray shadow{Geometry::offset_origin(hit, direction), direction, hit.time};
        shadow.kind = RayKind::shadow;
        SurfaceHit met;
        return !meet(shadow, met) || glows(met, -direction);
    }

    /// Whether little of what is seen glows or is reached by light: of what glows, or from outside,
    /// that of distant lights and the sky.
    bool is_dark() const {
        int seen = 0, reached = 0;
        for_all([&](float x, float y) {
            const Ray view = view_ray(x, y);
            SurfaceHit hit;
            if (!follow(scene_, geometry_, view, hit)) return;
            ++seen;
            reached += is_reached(hit, view.direction);
        });
        return seen > 0 && float(reached) < kLeastReached * float(seen);
    }

    bool is_reached(const SurfaceHit& hit, Vec3 view) const {
        if (glows(hit, -view)) return true;
        for (const LightDescription& light : scene_.lights)
            if (const auto* distant = std::get_if<DistantLight>(&light.value);
                distant && finds_light(hit, view, light.light_to_world.vector(distant->direction)))
                return true;
        const Frame frame = Frame::from_z(face_forward(hit.ng, -view));
        for (int i = 0; i < kSkyRays; ++i) {
            constexpr float kGolden = 0.61803399f;  // spreads azimuths evenly
            const float turn = float(i) * kGolden;
            const Vec2 u{(float(i) + 0.5f) / kSkyRays, turn - std::floor(turn)};
            if (finds_light(hit, view, frame.to_world(square_to_cosine_hemisphere(u)))) return true;
        }
        return false;
    }

    /// Visits the middles of a grid of the unit square.
    template <typename Visit>
    static void for_all(const Visit& visit) {
        for (int i = 0; i < kSide * kSide; ++i)
            visit((float(i % kSide) + 0.5f) / kSide, (float(i / kSide) + 0.5f) / kSide);
    }

    /// Power by which a point light brings what it lights to the goal.
    float power_at(Vec3 place) {
        if (!materials_) materials_.emplace(scene_, textures_);
        std::vector<float> lit;
        auto add = [&, number = 0](const Ray& ray) mutable {
            SurfaceHit hit;
            ++number;
            if (!follow(scene_, geometry_, ray, hit)) return;
            const float e = irradiance(hit, place);
            if (!(e > 0) || !std::isfinite(e)) return;
            const float others = irradiance_by_others(hit, ray.direction, place, number);
            lit.push_back(std::max(e, (e + others) * (kGoal / kGoalWithOthers)));
        };
        for_all([&](float x, float y) { add(view_ray(x, y)); });
        if (float(lit.size()) < kLeastLit * kSide * kSide)  // nothing that is in view: all around
            for_all([&](float x, float y) {
                add(Ray{place, square_to_sphere({x, y}), scene_.camera.shutter_open});
            });
        const float scale = imaging_scale(scene_);
        float typical = 1 / std::max(sqr(geometry_.bounds().radius()), 1e-12f);
        if (!lit.empty()) {
            const auto bright =
                lit.begin() + static_cast<std::ptrdiff_t>(kBrighterThan * float(lit.size()));
            std::nth_element(lit.begin(), bright, lit.end());
            typical = *bright;
        }
        const float power = 4 * kPi * kGoal * kPi / (typical * (scale > 0 ? scale : 1));
        return std::clamp(power, 1e-20f, 1e20f);
    }

    void tell(LampDescription lamp, Vec3 place) {
        lamp.at = place;
        const std::string text = '"' + lamp_text(lamp) + '"';
        scene_.warnings.push_back(
            {{},
             lamp.is_for_the_dark
                 ? "walls keep the sky and the key light from most of what is seen; a lamp at the "
                   "camera lights it (option light): " +
                       text
                 : "a lamp has the power that suits the view: " + text});
    }

    void light(const LampDescription& lamp, Vec3 place) {
        if (lamp.area_light >= 0) {
            scene_.area_lights[static_cast<size_t>(lamp.area_light)].power = lamp.power;
            return;
        }
        PointLight point;
        point.intensity = lamp.colour;
        point.power = lamp.power;
        point.from = place;
        scene_.lights.push_back({point, {}, {}});
    }

    SceneDescription& scene_;
    const Geometry& geometry_;
    const TextureStore& textures_;
    const Camera camera_;
    std::optional<MaterialStore> materials_;  ///< as they are in white light; none: not asked for
};

}  // namespace

const SceneDescription& stand_lamps(SceneDescription& scene, const Geometry& geometry,
                                    const TextureStore& textures) {
    if (!scene.lamps.empty()) Lamps(scene, geometry, textures).stand();
    return scene;
}

}  // namespace covtrace
