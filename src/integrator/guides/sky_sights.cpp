/// Rays to the sky, from places that paths from the camera meet.
#include <cmath>
#include <optional>

#include "core/frame.h"
#include "core/warp.h"
#include "integrator/guides/sky_guide.h"
#include "integrator/guides/training_places.h"
#include "integrator/visibility.h"

namespace covtrace {

namespace {

constexpr uint64_t kSightKey = 0x736b79ull;  // key of the random numbers, "sky"
constexpr float kByGuide = 0.6f;             // share of the directions that a guide chooses

/// A place where a path scatters, with what is known there.
class Place {
  public:
    Place(const LitScene& scene, const SkyGuide& guide, const PathVertex& vertex, Rng& rng)
        : scene_(scene),
          hit_(vertex.hit),
          normal_(face_forward(vertex.shading.z, vertex.wo)),
          rng_(rng) {
        if (const SkyCell* known = guide.at(hit_.position, normal_)) {
            cell_ = *known;
            cell_.share = 1;
            by_guide_ = kByGuide;
        }
    }

    /// Tries a direction: keeps it in `sights` where it reaches the sky.
    void look(std::vector<SkySight>& sights) {
        const std::optional<Vec3> w = direction();
        if (!w) return;
        const float cosine = dot(normal_, *w);
        // Discs are sampled as they are, whatever the guide knows
        if (!(cosine > 0) || scene_.lights.is_in_disc(*w)) return;
        const Lights::Sky sky =
            scene_.lights.sky(hit_.position, normal_, *w, nullptr, RayKind::diffuse);
        const float light = luminance(sky.radiance) * cosine;
        if (!(light > 0) || !std::isfinite(light)) return;
        Ray ray;
        ray.origin = Geometry::offset_origin(hit_, *w);
        ray.direction = *w;
        ray.time = hit_.time;
        if (is_hidden(scene_, ray)) return;
        SkySight sight{{hit_.position, normal_}, *w, light, 0, sky.pdf, 0};
        sight.tried_pdf = (1 - by_guide_) / 2 * (sky.pdf + cosine_hemisphere_pdf(cosine));
        if (by_guide_ > 0) {
            sight.tried_pdf += by_guide_ * cell_.pdf(*w);
            sight.guide_pdf = scene_.lights.sky(hit_.position, normal_, *w, &cell_).pdf;
        }
        sights.push_back(sight);
    }

  private:
    /// A direction by the guide, by the lights' own sampling, or by the cosine.
    std::optional<Vec3> direction() {
        const float choice = rng_.next_float(), u_select = rng_.next_float();
        const Vec2 u = rng_.next_2d();
        if (choice < by_guide_) return cell_.sample(u);
        if (choice < by_guide_ + (1 - by_guide_) / 2)
            return Frame::from_z(normal_).to_world(square_to_cosine_hemisphere(u));
        const auto light = scene_.lights.sample(hit_.position, normal_, hit_.time, u_select, u);
        if (!light || light->is_delta || std::isfinite(light->distance)) return std::nullopt;
        return light->wi;
    }

    const LitScene& scene_;
    const SurfaceHit& hit_;
    const Vec3 normal_;
    Rng& rng_;
    SkyCell cell_;
    float by_guide_ = 0;
};

}  // namespace

std::vector<SkySight> look_for_sky(const LitScene& scene, const SkyGuide& guide, int64_t first,
                                   int64_t count, int trials) {
    return visit_places<SkySight>(
        scene, kSightKey, first, count,
        [&](const PathVertex& vertex, Rng& rng, std::vector<SkySight>& found) {
            Place place(scene, guide, vertex, rng);
            for (int t = 0; t < trials; ++t) place.look(found);
        });
}

}  // namespace covtrace
