/// Photons that the guide to caustics learns from: paths from the camera find glossy surfaces, and
/// light of sampled lamps is sent over these.
#include <cmath>
#include <optional>

#include "core/hash.h"
#include "core/parallel.h"
#include "core/rng.h"
#include "core/warp.h"
#include "integrator/caustic_guide.h"
#include "integrator/lit_scene.h"

namespace covtrace {

namespace {

constexpr uint64_t kPilotKey = 0x6361757374696373ull;  // key of the random numbers, "caustics"
constexpr int kPathsPerChunk = 64;                     // pilot paths that one task traces
constexpr int kCameraVertices = 4;   // vertices of a pilot path that may be glossy surfaces
constexpr int kChainVertices = 8;    // most glossy surfaces in a row that light is sent over
constexpr int kMostInterfaces = 64;  // most interfaces between media that a ray passes through
constexpr int kLightSamples = 2;     // samples of lights at every glossy surface found

/// A pilot path from the camera, and the light sent over the glossy surfaces that it finds.
class Pilot {
  public:
    Pilot(const LitScene& scene, uint64_t index, std::vector<CausticPhoton>& photons)
        : scene_(scene), rng_(hash_combine(kPilotKey, index)), photons_(photons) {}

    void run() {
        const FilmDescription& film = scene_.description.film;
        const Vec2 u = rng_.next_2d();
        const Vec2 lens = rng_.next_2d();
        Ray ray = scene_.camera.generate_ray({u.x * float(film.width), u.y * float(film.height)},
                                             lens, rng_.next_float());
        for (int i = 0; i < kCameraVertices; ++i) {
            SurfaceHit hit;
            Bsdf bsdf;
            if (!next_surface(ray, hit, bsdf)) return;
            const Frame frame = shading_frame(hit);
            if (has_sharp_lobe(bsdf))
                for (int k = 0; k < kLightSamples; ++k) send_light(hit, bsdf, frame);
            const float u_lobe = rng_.next_float();
            const auto s = sample(bsdf, frame.to_local(-ray.direction), u_lobe, rng_.next_2d());
            if (!s || is_black(s->weight)) return;
            follow(ray, hit, normalize(frame.to_world(s->wi)));
        }
    }

  private:
    static void follow(Ray& ray, const SurfaceHit& hit, Vec3 direction) {
        ray.origin = Geometry::offset_origin(hit, direction);
        ray.direction = direction;
        ray.t_max = kInfinity;
    }

    /// Finds the nearest surface that is no interface; returns its distance from where `ray`
    /// began. The ray itself begins at the last interface afterwards.
    std::optional<float> next_surface(Ray& ray, SurfaceHit& hit, Bsdf& bsdf) const {
        float distance = 0;
        for (int i = 0; i < kMostInterfaces; ++i) {
            if (!scene_.geometry.intersect(ray, hit)) return std::nullopt;
            distance += hit.t;
            const PlacedShape& shape = scene_.geometry.shapes()[hit.shape];
            const MaterialId material =
                scene_.materials.at(shape.description.material, hit, scene_.textures);
            bsdf = scene_.materials.bsdf(material, hit, scene_.textures);
            if (!std::holds_alternative<InterfaceBsdf>(bsdf)) return distance;
            ray.origin = Geometry::offset_origin(hit, ray.direction);
        }
        return std::nullopt;
    }

    /// Sends light of one sampled lamp to `start`, by a lobe there that is not diffuse and on to
    /// where it lands: a photon is left on the first surface with a diffuse lobe.
    void send_light(const SurfaceHit& start, const Bsdf& start_bsdf, const Frame& start_frame) {
        // Sample a lamp
        const float u_select = rng_.next_float();
        const auto light =
            scene_.lights.sample(start.position, Vec3{}, start.time, u_select, rng_.next_2d());
        if (!light || is_black(light->radiance) || !(light->pdf > 0)) return;
        Ray shadow;
        shadow.time = start.time;
        follow(shadow, start, light->wi);
        if (std::isfinite(light->distance)) shadow.t_max = light->distance * (1 - 1e-3f);
        if (scene_.geometry.occluded(shadow)) return;

        // Follow the lamp's light from one lobe that is not diffuse to the next
        float travelled = light->distance;
        // The density of a sky's samples may be next to 0, as BSDFs find its light, too; without a
        // uniform density added to it such photons would have weights without bound.
        const bool is_sky = !light->is_delta && !std::isfinite(light->distance);
        Rgb weight = light->radiance / (light->pdf + (is_sky ? kUniformSpherePdf : 0.0f));
        SurfaceHit hit = start;
        Bsdf bsdf = start_bsdf;
        Frame frame = start_frame;
        Ray ray;
        ray.time = start.time;
        Vec3 towards_light = light->wi;
        for (int i = 0; i < kChainVertices; ++i) {
            const float u_lobe = rng_.next_float();
            const auto s = sample(bsdf, frame.to_local(towards_light), u_lobe, rng_.next_2d());
            if (!s || is_black(s->weight) || is_diffuse(s->lobe)) return;
            weight *= s->weight;
            const uint64_t source = hash_combine(uint64_t(light->light), hit.shape, hit.instance);
            follow(ray, hit, normalize(frame.to_world(s->wi)));
            const std::optional<float> distance = next_surface(ray, hit, bsdf);
            if (!distance) return;
            travelled += *distance;
            towards_light = -ray.direction;
            if (has_diffuse_lobe(bsdf)) {
                const float y = luminance(weight);
                if (std::isfinite(y) && y > 0)
                    photons_.push_back({Geometry::offset_origin(hit, towards_light),
                                        face_forward(hit.ns, towards_light), hit.time,
                                        towards_light, travelled, y, source});
                return;
            }
            frame = shading_frame(hit);
        }
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
        for (int64_t i = chunk * kPathsPerChunk; i < end; ++i)
            Pilot(scene, static_cast<uint64_t>(first + i), found[static_cast<size_t>(chunk)]).run();
    });
    std::vector<CausticPhoton> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace covtrace
