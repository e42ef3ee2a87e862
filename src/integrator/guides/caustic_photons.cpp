/// Photons that the guide to caustics learns from: paths from the camera find glossy surfaces, and
/// light of sampled lamps is sent over these.
#include <cmath>
#include <optional>

#include "core/hash.h"
#include "core/parallel.h"
#include "core/rng.h"
#include "core/warp.h"
#include "integrator/guides/caustic_photons.h"
#include "integrator/lit_scene.h"
#include "integrator/mirrored_light.h"
#include "integrator/panes.h"
#include "integrator/power_heuristic.h"
#include "integrator/visibility.h"

namespace covtrace {

namespace {

constexpr uint64_t kPilotKey = 0x6361757374696373ull;  // key of the random numbers, "caustics"
constexpr int kPathsPerChunk = 64;                     // pilot paths that one task traces
constexpr int kCameraVertices = 4;  // vertices of a pilot path that may be glossy surfaces
constexpr int kChainVertices = 8;   // most glossy surfaces in a row that light is sent over
constexpr int kMostPassed = 64;     // most interfaces between media that a ray passes through
constexpr int kLightSamples = 4;    // samples of lights at and around every glossy surface found
/// Largest radius of the search around such a surface, as a share of its distance, and the smallest
/// as a share of that; the logarithms in between are alike.
constexpr float kWidestSearch = 0.3f, kNarrowestSearch = 0.03f;

/// A pilot path from the camera, and the light sent over the glossy surfaces that it finds.
class Pilot {
  public:
    Pilot(const LitScene& scene, uint64_t index, std::vector<CausticPhoton>& photons)
        : scene_(scene), rng_(hash_combine(kPilotKey, index)), photons_(photons) {}

    void run() {
        const FilmDescription& film = scene_.description.film;
        const Vec2 u = rng_.next_2d();
        const Vec2 lens = rng_.next_2d();
        const CameraRay seen = scene_.camera.generate_ray(
            {u.x * float(film.width), u.y * float(film.height)}, lens, rng_.next_float());
        if (!seen.sees) return;
        Ray ray = seen;
        bool sees = true;  // all lobes so far were specular
        for (int i = 0; i < kCameraVertices; ++i) {
            SurfaceHit hit;
            Bsdf bsdf;
            if (!next_surface(ray, hit, bsdf, sees)) return;
            const Frame frame = shading_frame(hit);
            if (has_sharp_lobe(bsdf)) send_light_around(hit.position, hit.t, hit.time);
            const float u_lobe = rng_.next_float();
            const auto s = sample(bsdf, frame.to_local(-ray.direction), u_lobe, rng_.next_2d());
            if (!s || is_black(s->weight) || enters_body(bsdf, *s)) return;
            sees = sees && is_specular(s->lobe);
            follow(ray, hit, normalize(frame.to_world(s->wi)));
        }
    }

  private:
    /// Sends light to a place that is seen from `distance` away, and to others around it: light
    /// comes over sides of a surface that the camera does not see, too.
    void send_light_around(Vec3 place, float distance, float time) {
        send_light(place, time);
        for (int k = 1; k < kLightSamples; ++k) {
            const float radius =
                kWidestSearch * distance * std::pow(kNarrowestSearch, rng_.next_float());
            send_light(place + square_to_sphere(rng_.next_2d()) * radius, time);
        }
    }
    static void follow(Ray& ray, const SurfaceHit& hit, Vec3 direction) {
        ray.origin = Geometry::offset_origin(hit, direction);
        ray.direction = direction;
        ray.t_max = kInfinity;
        ray.kind = RayKind::any;
    }

    /// Finds the nearest surface that light does not pass unchanged; returns its distance from
    /// where `ray` began. The ray itself begins at the last interface afterwards. `sees`: the ray
    /// is one by which the camera sees.
    std::optional<float> next_surface(Ray& ray, SurfaceHit& hit, Bsdf& bsdf,
                                      bool sees = false) const {
        float distance = 0;
        for (int i = 0; i < kMostPassed; ++i) {
            if (!scene_.geometry.intersect(ray, hit)) return std::nullopt;
            distance += hit.t;
            const PlacedShape& shape = scene_.geometry.shapes()[hit.shape];
            const MaterialId material =
                scene_.materials.at(shape.description.material, hit, scene_.textures).id;
            bsdf = scene_.materials.bsdf(material, hit, scene_.textures);
            if (!shape.lets_light_pass && !scene_.materials.lets_light_pass(material) &&
                !(sees && is_unseen_back(shape, hit, ray.direction)))
                return distance;
            ray.origin = Geometry::offset_origin(hit, ray.direction);
        }
        return std::nullopt;
    }

    /// Sends light of one sampled lamp towards `target`, over the surface that it meets first, if
    /// that has a sharp lobe, and on to where it lands: a photon is left on the first surface with
    /// a diffuse lobe.
    void send_light(Vec3 target, float time) {
        // Sample a lamp
        const float u_select = rng_.next_float();
        const auto light = scene_.lights.sample(target, Vec3{}, time, u_select, rng_.next_2d());
        if (!light || is_black(light->radiance) || !(light->pdf > 0)) return;
        // Follow its light to the first surface
        const bool is_far = !std::isfinite(light->distance);
        const float back = is_far ? scene_.unbounded_distance : light->distance * (1 - 1e-3f);
        Ray ray{target + light->wi * back, -light->wi, time, kInfinity, RayKind::any};
        SurfaceHit hit;
        Bsdf bsdf;
        const std::optional<float> to_first = next_surface(ray, hit, bsdf);
        if (!to_first || !has_sharp_lobe(bsdf)) return;

        // Follow it from one lobe that is not diffuse to the next
        float travelled = light->distance - (is_far ? 0 : back) + *to_first;
        // The density of a sky's samples may be next to 0, as BSDFs find its light, too; without a
        // uniform density added to it such photons would have weights without bound.
        const bool is_sky = !light->is_delta && is_far;
        Rgb weight = light->radiance / (light->pdf + (is_sky ? kUniformSpherePdf : 0.0f));
        Frame frame = shading_frame(hit);
        Vec3 towards_light = light->wi;
        auto source = uint64_t(light->light);
        SampledWay way{.through_panes = scene_.samples_through_panes ? 1.0f : 0.0f};
        for (int i = 0; i < kChainVertices; ++i) {
            const float u_lobe = rng_.next_float();
            const auto s = sample(bsdf, frame.to_local(towards_light), u_lobe, rng_.next_2d());
            if (!s || is_black(s->weight) || is_diffuse(s->lobe) || enters_body(bsdf, *s)) return;
            weight *= s->weight;
            const bool is_reflected = (frame.to_local(towards_light).z > 0) == (s->wi.z > 0);
            source = hash_combine(source, hit.shape, hit.instance, is_reflected);
            const bool is_pane = scene_.geometry.shapes()[hit.shape].is_pane;
            way.through_panes *= is_pane && is_transmission(s->lobe) ? s->pdf : 0;
            const bool may_be_sampled =
                i == 0 && is_reflected && is_specular(s->lobe) && scene_.samples_by_mirrors;
            way.mirror = may_be_sampled ? scene_.mirrors.at(hit) : -1;
            if (way.mirror >= 0) {
                way.from_mirror = {Geometry::offset_origin(hit, towards_light), towards_light, time,
                                   kInfinity, RayKind::any};
                way.reflected = s->pdf;
            }
            follow(ray, hit, normalize(frame.to_world(s->wi)));
            const std::optional<float> distance = next_surface(ray, hit, bsdf);
            if (!distance) return;
            travelled += *distance;
            towards_light = -ray.direction;
            if (has_diffuse_lobe(bsdf)) {
                const float y = luminance(weight);
                if (std::isfinite(y) && y > 0 && !is_sampled(hit, towards_light, way))
                    photons_.push_back({Geometry::offset_origin(hit, towards_light),
                                        face_forward(hit.ns, towards_light), hit.time,
                                        towards_light, travelled, y, source});
                return;
            }
            frame = shading_frame(hit);
        }
    }

    /// The way of a photon, where light is sampled by the same ones.
    struct SampledWay {
        float through_panes = 0;  ///< probability of having gone through panes alone; 0: other ways
        int mirror = -1;          ///< flat mirror that alone it met; -1: other ways
        Ray from_mirror;          ///< from there back to the light
        float reflected = 0;      ///< probability of having been reflected there
    };

    /// Whether a photon is to be left out, as such light is sampled: it is kept with the weight
    /// that is left to paths.
    bool is_sampled(const SurfaceHit& hit, Vec3 towards_light, const SampledWay& way) {
        const Vec3 normal = face_forward(hit.ns, towards_light);
        const LitPlace place{hit.position, normal};
        float sampled = 0, own = cosine_hemisphere_pdf(dot(normal, towards_light));
        if (way.through_panes > 0) {
            const Ray ray{Geometry::offset_origin(hit, towards_light), towards_light, hit.time,
                          kInfinity, RayKind::any};
            uint64_t rays = 0;
            sampled = density_through_panes(scene_, place, ray, 0, rays);
            own *= way.through_panes;
        } else if (way.mirror >= 0) {
            SurfaceHit lamp;
            const bool found = scene_.geometry.intersect(way.from_mirror, lamp);
            sampled = density_by_mirror(scene_, way.mirror, place, way.from_mirror.direction,
                                        found ? &lamp : nullptr);
            own *= way.reflected;
        } else {
            return false;
        }
        return rng_.next_float() < power_heuristic(sampled, own);
    }

    const LitScene& scene_;
    Rng rng_;
    std::vector<CausticPhoton>& photons_;
};

}  // namespace

std::vector<CausticPhoton> trace_caustic_photons(const LitScene& scene, int64_t first,
                                                 int64_t count) {
    const int64_t chunks = (count + kPathsPerChunk - 1) / kPathsPerChunk;
    std::vector<std::vector<CausticPhoton>> found(static_cast<size_t>(chunks));
    parallel_for(chunks, [&](int64_t chunk) {
        const int64_t end = std::min(count, (chunk + 1) * kPathsPerChunk);
        for (int64_t i = chunk * kPathsPerChunk; i < end; ++i) {
            scene.throw_if_interrupted();
            Pilot(scene, static_cast<uint64_t>(first + i), found[static_cast<size_t>(chunk)]).run();
        }
    });
    std::vector<CausticPhoton> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace covtrace
