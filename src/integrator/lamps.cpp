#include "integrator/lamps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/sampler.h"
#include "core/warp.h"
#include "integrator/view_probe.h"
#include "scene/added_lamps.h"
#include "scene/imaging_scale.h"
#include "shading/material.h"

namespace covtrace {

namespace {

/// Value of a white surface in the direct light of all lamps, where that is more than in so large a
/// share of what is seen. The rest, near the lamp, may be brighter.
constexpr float kGoal = 0.6f, kBrighterThan = 0.75f;
/// Value of a white surface with the light that others send on, where that is more than as much
/// again: in white rooms and near a wall behind the lamp.
constexpr float kGoalWithOthers = 1.2f;
constexpr uint32_t kPaths = 8;     // per place, that look for light which others send on
constexpr int kMostSent = 8;       // surfaces that such a path meets
constexpr float kLeastLit = 0.1f;  // share of the rays by which a lamp has to be seen to light

/// Lamps of one scene.
class Lamps {
  public:
    Lamps(SceneDescription& scene, const Geometry& geometry, const TextureStore& textures)
        : scene_(scene),
          geometry_(geometry),
          textures_(textures),
          probe_(scene, geometry, textures) {}

    void stand() {
        std::erase_if(scene_.lamps, [&](const LampDescription& l) {
            return l.is_for_the_dark && !probe_.is_dark();
        });
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
    Vec3 beside_camera() const {
        const Ray ray = probe_.view_ray(0.5f, 0.5f);
        Vec3 place = ray.origin;
        SurfaceHit hit;
        probe_.follow(ray, hit, &place);
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
            Sampler sampler(0, number % ViewProbe::kSide, number / ViewProbe::kSide, path);
            SurfaceHit hit = seen;
            Vec3 direction = view;
            float share = 1;
            for (int i = 1; i < std::min(scene_.max_depth, kMostSent) && share > 0; ++i) {
                const Frame frame = Frame::from_z(face_forward(hit.ng, -direction));
                direction = frame.to_world(square_to_cosine_hemisphere(sampler.next_2d()));
                Ray ray{Geometry::offset_origin(hit, direction), direction, hit.time};
                ray.kind = RayKind::diffuse;
                if (!probe_.meet(ray, hit)) break;
                share *= albedo_of(hit, direction);
                if (dot(hit.ng, direction) * dot(hit.ng, lamp - hit.position) < 0)
                    sum += share * irradiance(hit, lamp);
            }
        }
        return float(sum / kPaths);
    }

    /// Power by which a point light brings what it lights to the goal.
    float power_at(Vec3 place) {
        if (!materials_) materials_.emplace(scene_, textures_);
        std::vector<float> lit;
        auto add = [&, number = 0](const Ray& ray) mutable {
            SurfaceHit hit;
            ++number;
            if (!probe_.follow(ray, hit)) return;
            const float e = irradiance(hit, place);
            if (!(e > 0) || !std::isfinite(e)) return;
            const float others = irradiance_by_others(hit, ray.direction, place, number);
            lit.push_back(std::max(e, (e + others) * (kGoal / kGoalWithOthers)));
        };
        ViewProbe::for_all([&](float x, float y) { add(probe_.view_ray(x, y)); });
        if (float(lit.size()) <
            kLeastLit * ViewProbe::kSide * ViewProbe::kSide)  // nothing that is in view: all around
            ViewProbe::for_all([&](float x, float y) {
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
    const ViewProbe probe_;
    std::optional<MaterialStore> materials_;  ///< as they are in white light; none: not asked for
};

}  // namespace

const SceneDescription& stand_lamps(SceneDescription& scene, const Geometry& geometry,
                                    const TextureStore& textures) {
    if (!scene.lamps.empty()) Lamps(scene, geometry, textures).stand();
    return scene;
}

}  // namespace covtrace
