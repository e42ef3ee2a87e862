/// Lamps tried at places that paths from the camera meet.
#include <cmath>

#include "integrator/guides/lamp_guide.h"
#include "integrator/guides/training_places.h"
#include "integrator/visibility.h"
#include "shading/strand.h"

namespace covtrace {

namespace {

constexpr uint64_t kTrialKey = 0x6c616d7073ull;  // key of the random numbers, "lamps"

/// A place where a path scatters, with what is known there.
class TrialPlace {
  public:
    TrialPlace(const LitScene& scene, const PathVertex& vertex)
        : scene_(scene),
          vertex_(vertex),
          bsdf_(scene.materials.bsdf(vertex.material, vertex.hit, scene.textures)),
          normal_(face_forward(vertex.shading.z, vertex.wo)) {
        const PlacedShape& shape = scene.geometry.shapes()[vertex.hit.shape];
        place_on_strand(bsdf_, vertex.hit, shape.description.tube_sides, vertex.wo);
    }

    /// Tries a lamp and appends what became of it.
    void try_lamp(Rng& rng, std::vector<LampTrial>& found) {
        const float u_select = rng.next_float();
        const Vec2 u = rng.next_2d();
        const SurfaceHit& hit = vertex_.hit;
        scene_.lights.try_finite(hit.position, normal_, hit.time, u_select, u, trial_);
        if (trial_.way.empty()) return;
        LampTrial t;
        t.place = {hit.position, normal_};
        if (trial_.sample && trial_.sample->pdf > 0) look(*trial_.sample, t);
        add_steps(t);
        found.push_back(std::move(t));
    }

  private:
    /// Looks whether a point of a lamp is seen, and what the surface scatters of it.
    void look(const LightSample& light, LampTrial& t) const {
        const SurfaceHit& hit = vertex_.hit;
        const BsdfValue value = eval_and_pdf(bsdf_, vertex_.shading.to_local(vertex_.wo),
                                             vertex_.shading.to_local(light.wi));
        const float brought = luminance(value.f * light.radiance);
        if (!(brought > 0) || !std::isfinite(brought)) return;
        Ray ray;
        ray.origin = Geometry::offset_origin(hit, light.wi);
        ray.time = hit.time;
        if (!(aim(ray, light) > 0)) return;
        // Light without extent is not sampled through panes
        if (light.is_delta ? scene_.geometry.occluded(ray) : is_hidden(scene_, ray)) return;
        t.light = light.light;
        t.light_found = brought;
        t.tried_pdf = light.pdf;
        t.place_pdf = trial_.place_pdf;
        t.bsdf_pdf = light.is_delta ? 0.0f : value.pdf;
    }

    /// Adds what each step led to: the square of an estimate of what its child brings, over the
    /// child's importance.
    void add_steps(LampTrial& t) const {
        // Light that BSDFs find as well counts by the part that the choice of lamps is to find
        float choice = 1, below_tried = 1, below_tree = 1;
        for (const LightTree::Step& step : trial_.way) choice *= step.probability;
        const float by_lights = choice * t.place_pdf;
        const float found = t.light_found > 0
                                ? t.light_found / t.place_pdf * by_lights / (by_lights + t.bsdf_pdf)
                                : 0.0f;
        t.steps.resize(trial_.way.size());
        for (size_t i = trial_.way.size(); i-- > 0;) {
            const LightTree::Step& step = trial_.way[i];
            const float square = sqr(found / step.importance) / (below_tried * below_tree);
            t.steps[i] = {step.child, std::isfinite(square) ? square : 0.0f};
            below_tried *= step.tried;
            below_tree *= step.probability;
        }
    }

    const LitScene& scene_;
    const PathVertex& vertex_;
    Bsdf bsdf_;
    const Vec3 normal_;
    Lights::Trial trial_;
};

}  // namespace

std::vector<LampTrial> try_lamps(const LitScene& scene, int64_t first, int64_t count, int trials) {
    return visit_places<LampTrial>(
        scene, kTrialKey, first, count,
        [&](const PathVertex& vertex, Rng& rng, std::vector<LampTrial>& found) {
            TrialPlace place(scene, vertex);
            for (int t = 0; t < trials; ++t) place.try_lamp(rng, found);
        });
}

}  // namespace covtrace
