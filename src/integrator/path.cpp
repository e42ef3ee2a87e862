#include "integrator/path.h"

#include <cmath>

#include "integrator/visibility.h"
#include "shading/normal_map.h"
#include "shading/phase_function.h"

namespace covtrace {

namespace {

float power_heuristic(float a, float b) {
    if (std::isinf(a)) return 1;
    if (std::isinf(b)) return 0;
    // A lamp far away has a density whose square is no float any more.
    constexpr float kLargest = 1e18f;
    if (const float largest = std::max(a, b); largest > kLargest) {
        a /= largest;
        b /= largest;
    }
    const float a2 = a * a, b2 = b * b;
    return a2 + b2 > 0 ? a2 / (a2 + b2) : 0;
}

bool transmits(const Bsdf& bsdf) {
    return std::holds_alternative<DielectricBsdf>(bsdf) ||
           std::holds_alternative<DiffuseTransmissionBsdf>(bsdf) ||
           std::holds_alternative<ThinDielectricBsdf>(bsdf);
}

/// One path in the making. The estimate is  sum over vertices of  beta * (emission + direct light),
/// beta = product of  f |cos| / pdf  and of the weights of media so far; each kind of light is
/// found by two strategies whose weights add to one.
class PathTracer {
  public:
    PathTracer(const RenderScene& scene, Ray ray, Sampler& sampler, int max_depth,
               PathRecord* record)
        : scene_(scene), ray_(ray), sampler_(sampler), max_depth_(max_depth), record_(record) {
        camera_origin_ = ray.origin;
        medium_ = scene.description.camera.medium;
    }

    PathResult run() {
        if (record_) {
            record_->clear();
            record_->camera_ray = ray_;
        }
        while (step()) {
        }
        return result_;
    }

  private:
    static constexpr uint32_t kPairsPerBounce = 4;
    /// Media draw from dimensions of their own, so that surfaces see the same numbers with or
    /// without them: one pair for each piece between interfaces.
    static constexpr uint32_t kMediumPairs = 1u << 20;

    /// Follows the ray to where it meets something; false where the path ends.
    bool step() {
        SurfaceHit hit;
        ++(depth_ == 0 ? result_.rays.camera : result_.rays.bounce);
        const bool found = scene_.geometry.intersect(ray_, hit);
        if (medium_ >= 0) {
            const float length = found ? hit.t : scene_.unbounded_distance;
            const MediumEvent event = cross_medium(length);
            if (event.scatters) return scatter_in_medium(event.distance);
        }
        if (!found) {
            escape();
            return false;
        }
        const PlacedShape& shape = scene_.geometry.shapes()[hit.shape];
        const MaterialId material =
            scene_.materials.at(shape.description.material, hit, scene_.textures);
        // As pbrt, wherever the path has been: the pixel's width at this distance from the eye, and
        // an eighth of it, so that the filter of the texture adds nothing to that of the pixel.
        const Vec3 from_eye = hit.position - camera_origin_;
        const float away = length(from_eye);
        const Bsdf bsdf =
            away > 0 ? scene_.materials.bsdf(material, hit, scene_.textures, from_eye / away,
                                             scene_.camera.half_pixel(away) / 4)
                     : scene_.materials.bsdf(material, hit, scene_.textures);
        if (!std::holds_alternative<InterfaceBsdf>(bsdf))
            return meet_surface(hit, shape, material, bsdf);
        medium_ = medium_beyond(shape, hit, ray_.direction, medium_);
        ray_.origin = Geometry::offset_origin(hit, ray_.direction);
        return ++passed_interfaces_ <= kMostInterfaces;
    }

    bool meet_surface(const SurfaceHit& hit, const PlacedShape& shape, MaterialId material,
                      const Bsdf& bsdf) {
        const Vec3 wo = -ray_.direction;
        PathVertex* vertex = begin_vertex(hit, -1, wo);
        if (vertex) vertex->material = material;
        add_emission(hit, wo, vertex);
        const Frame frame = frame_at(hit, shape, material);
        const Vec3 wo_local = frame.to_local(wo);
        if (depth_ == 0)
            describe_first_vertex(hit.position, albedo(bsdf, wo_local), face_forward(frame.z, wo));
        if (vertex) vertex->shading = frame;
        if (depth_++ == max_depth_) return false;
        sampler_.set_dimension(static_cast<uint32_t>(depth_) * kPairsPerBounce);
        const Vec2 u_choice = sampler_.next_2d();
        const Vec2 u_light = sampler_.next_2d(), u_bsdf = sampler_.next_2d();
        // Lights are chosen for the side that can be lit: the viewer's, or both where light
        // passes through.
        light_normal_ = transmits(bsdf) ? Vec3{} : face_forward(frame.z, wo);
        guide_ = has_diffuse_lobe(bsdf) && depth_ < max_depth_
                     ? scene_.guide.at(hit.position, light_normal_)
                     : GuideMixture{};
        if (!is_specular(bsdf))
            add_direct(hit, shape, bsdf, frame, wo_local, u_choice.x, u_light, vertex);
        return scatter(hit, shape, bsdf, frame, wo_local, u_choice.y, u_bsdf, vertex) && survives();
    }

    /// Adds what the medium emits on the way and decides whether the ray gets through.
    MediumEvent cross_medium(float length) {
        const Medium& medium = scene_.media[static_cast<size_t>(medium_)];
        if (depth_ < max_depth_ && !is_black(medium.emission)) {
            const Rgb contribution = beta_ * emitted_along(medium, length);
            result_.radiance += contribution;
            if (record_) glow_ += luminance(contribution);
        }
        MediumEvent event{false, length, transmittance(medium, length)};
        if (depth_ < max_depth_ && medium.scatters()) {
            sampler_.set_dimension(kMediumPairs + static_cast<uint32_t>(passed_interfaces_) +
                                   static_cast<uint32_t>(depth_) * (kMostInterfaces + 1));
            event = sample_event(medium, length, beta_, sampler_.next_2d());
        }
        beta_ *= event.weight;
        return event;
    }

    bool scatter_in_medium(float distance) {
        if (is_black(beta_)) return false;
        const Medium& medium = scene_.media[static_cast<size_t>(medium_)];
        const Vec3 wo = -ray_.direction;
        SurfaceHit place;
        place.position = ray_.origin + ray_.direction * distance;
        place.time = ray_.time;
        PathVertex* vertex = begin_vertex(place, medium_, wo);
        if (depth_ == 0) describe_first_vertex(place.position, medium.albedo(), {});
        ++depth_;
        sampler_.set_dimension(static_cast<uint32_t>(depth_) * kPairsPerBounce);
        const float u_select = sampler_.next_2d().x;
        const Vec2 u_light = sampler_.next_2d(), u_phase = sampler_.next_2d();
        light_normal_ = {};
        Ray shadow;
        shadow.origin = place.position;
        shadow.time = place.time;
        if (const auto light =
                scene_.lights.sample(place.position, {}, place.time, u_select, u_light)) {
            const float p = henyey_greenstein(medium.g, -dot(wo, light->wi));
            add_light(
                *light, Rgb(p), [p] { return p; }, shadow, medium_, vertex);
        }
        const Vec3 wi = sample_phase(medium.g, wo, u_phase);
        pdf_ = henyey_greenstein(medium.g, -dot(wo, wi));
        specular_ = sharp_so_far_ = false;
        if (vertex) {
            vertex->scatters = true;
            vertex->next_event = {wi, {}};
        }
        previous_position_ = place.position;
        previous_normal_ = {};
        ray_.origin = place.position;
        ray_.direction = wi;
        return survives();
    }

    bool in_view() const { return sharp_so_far_ && sharp_probability_ > 0.5f; }

    void escape() {
        if (record_ && record_->count == static_cast<int>(result_.vertices)) {
            record_->escape_direction = ray_.direction;
            record_->escape_glow = glow_;
        }
        if (!scene_.lights.has_environment()) return;
        const Rgb light = scene_.lights.environment(ray_.direction);
        float weight = 1;
        if (!specular_) {
            const float p =
                scene_.lights.environment_pdf(previous_position_, previous_normal_, ray_.direction);
            weight = power_heuristic(pdf_, p);
        }
        const Rgb contribution = beta_ * light * weight;
        result_.radiance += contribution;
        if (in_view()) result_.in_view += contribution;
        if (record_ && record_->count == static_cast<int>(result_.vertices)) {
            record_->escaped = luminance(contribution);
            record_->escape_seen_sharply = sharp_so_far_;
            record_->escape_in_view = in_view();
        }
    }

    PathVertex* begin_vertex(const SurfaceHit& hit, MediumId medium, Vec3 wo) {
        ++result_.vertices;
        if (!record_ || record_->count == PathRecord::kCapacity) return nullptr;
        PathVertex* v = &record_->vertices[static_cast<size_t>(record_->count++)];
        v->hit = hit;
        v->medium = medium;
        v->wo = wo;
        v->material = -1;
        v->emitted = v->direct = 0;
        v->scatters = false;
        v->seen_sharply = sharp_so_far_;
        v->glow = glow_;
        glow_ = 0;
        v->in_view = in_view();
        return v;
    }

    void add_emission(const SurfaceHit& hit, Vec3 wo, PathVertex* vertex) {
        const Rgb light = scene_.lights.emitted(hit, wo);
        if (is_black(light)) return;
        float weight = 1;
        if (!specular_) {
            const float p =
                scene_.lights.pdf(previous_position_, previous_normal_, ray_.direction, hit);
            weight = power_heuristic(pdf_, p);
        }
        const Rgb contribution = beta_ * light * weight;
        result_.radiance += contribution;
        if (in_view()) result_.in_view += contribution;
        if (vertex) vertex->emitted = luminance(contribution);
    }

    /// The frame of the BSDF, with the material's bump or normal map.
    Frame frame_at(const SurfaceHit& hit, const PlacedShape& shape, MaterialId material) const {
        if (!scene_.materials.has_normal_map(material)) return shading_frame(hit);
        // A step as pbrt takes it for 64 samples per pixel and more: an eighth of half a pixel.
        const float footprint =
            scene_.camera.half_pixel(distance(camera_origin_, hit.position)) / 8;
        const DifferentialGeometry base = scene_.geometry.differential(hit);
        return NormalMap(scene_.materials.description(material), scene_.textures, shape, hit, base,
                         footprint)
            .frame();
    }

    void describe_first_vertex(Vec3 position, Rgb albedo, Vec3 normal) {
        result_.hit = true;
        result_.albedo = albedo;
        result_.normal = normal;
        result_.depth = distance(camera_origin_, position);
    }

    void add_direct(const SurfaceHit& hit, const PlacedShape& shape, const Bsdf& bsdf,
                    const Frame& frame, Vec3 wo_local, float u_select, Vec2 u, PathVertex* vertex) {
        const auto light = scene_.lights.sample(hit.position, light_normal_, hit.time, u_select, u);
        if (!light || is_black(light->radiance) || !(light->pdf > 0)) return;
        const Vec3 wi_local = frame.to_local(light->wi);
        const Rgb f = eval(bsdf, wo_local, wi_local);
        if (is_black(f)) return;
        Ray shadow;
        shadow.origin = Geometry::offset_origin(hit, light->wi);
        shadow.time = hit.time;
        const auto density = [&] { return direction_pdf(bsdf, wo_local, wi_local, light->wi); };
        if (add_light(*light, f, density, shadow, medium_beyond(shape, hit, light->wi, medium_),
                      vertex) &&
            vertex)
            vertex->direct_event.lobes = lobe_shares(bsdf, wo_local, wi_local);
    }

    /// Adds the light sampled at a vertex that scatters the part f of it into the path and would
    /// have found its direction with density `density()`. False where nothing of it arrives.
    template <typename Density>
    bool add_light(const LightSample& light, Rgb f, const Density& density, Ray shadow,
                   MediumId medium, PathVertex* vertex) {
        if (is_black(light.radiance) || !(light.pdf > 0)) return false;
        shadow.direction = light.wi;
        if (std::isfinite(light.distance)) {
            // Aim at the light from the moved origin and stop just short of it.
            const Vec3 to_light = light.position - shadow.origin;
            const float d = length(to_light);
            if (!(d > 0)) return false;
            shadow.direction = to_light / d;
            shadow.t_max = d * (1 - 1e-4f);
        }
        uint32_t rays = 0;
        const Rgb visible = visibility(scene_, shadow, light.distance, medium, rays);
        result_.rays.shadow += rays;
        if (is_black(visible)) return false;
        const float weight = light.is_delta ? 1.0f : power_heuristic(light.pdf, density());
        const Rgb contribution = beta_ * f * light.radiance * visible * (weight / light.pdf);
        result_.radiance += contribution;
        if (!vertex) return true;
        vertex->direct = luminance(contribution);
        vertex->light = light;
        vertex->direct_event = {light.wi, {}};
        return true;
    }

    /// Density of sample_direction to return a direction by other than specular lobes.
    float direction_pdf(const Bsdf& bsdf, Vec3 wo_local, Vec3 wi_local, Vec3 wi) const {
        const float own = pdf(bsdf, wo_local, wi_local), share = guide_.share();
        return share > 0 ? (1 - share) * own + share * guide_.pdf(wi) : own;
    }

    /// A direction by the BSDF or, for a share of the samples, by the guide. The weight counts
    /// both, whichever chose.
    std::optional<BsdfSample> sample_direction(const Bsdf& bsdf, const Frame& frame, Vec3 wo_local,
                                               float u_lobe, Vec2 u) {
        const float share = guide_.share();
        if (!(share > 0)) return sample(bsdf, wo_local, u_lobe, u);
        std::optional<BsdfSample> s;
        Vec3 wi;
        if (u_lobe < share) {
            wi = guide_.sample(u_lobe / share, u);
            s = BsdfSample{};
            s->wi = frame.to_local(wi);
            s->lobe = s->wi.z * wo_local.z > 0 ? LobeKind::diffuse_reflection
                                               : LobeKind::diffuse_transmission;
        } else {
            s = sample(bsdf, wo_local, (u_lobe - share) / (1 - share), u);
            if (!s) return s;
            if (is_specular(s->lobe)) {
                s->weight *= 1 / (1 - share);
                s->pdf *= 1 - share;
                return s;
            }
            wi = frame.to_world(s->wi);
        }
        s->pdf = direction_pdf(bsdf, wo_local, s->wi, wi);
        s->weight = s->pdf > 0 ? eval(bsdf, wo_local, s->wi) * (1 / s->pdf) : Rgb(0);
        // A throughput that is small because the guide expects much light from there must not end
        // the path: the roulette judges it as if the BSDF had chosen alone.
        const float own = pdf(bsdf, wo_local, s->wi);
        if (own > 0) roulette_scale_ *= s->pdf / own;
        return s;
    }

    bool scatter(const SurfaceHit& hit, const PlacedShape& shape, const Bsdf& bsdf,
                 const Frame& frame, Vec3 wo_local, float u_lobe, Vec2 u, PathVertex* vertex) {
        const auto s = sample_direction(bsdf, frame, wo_local, u_lobe, u);
        if (!s || is_black(s->weight)) return false;
        const Vec3 wi = normalize(frame.to_world(s->wi));
        beta_ *= s->weight;
        pdf_ = s->pdf;
        specular_ = is_specular(s->lobe);
        sharp_so_far_ = sharp_so_far_ && specular_;
        sharp_probability_ *= s->pdf;
        if (is_transmission(s->lobe)) roulette_scale_ *= s->eta * s->eta;
        if (vertex) {
            vertex->scatters = true;
            vertex->next_event.wi = wi;
            if (specular_) {
                vertex->next_event.lobes.count = 1;
                vertex->next_event.lobes.lobes[0] = {s->lobe, s->weight, 0, 0, s->eta};
            } else {
                vertex->next_event.lobes = lobe_shares(bsdf, wo_local, s->wi);
            }
        }
        previous_position_ = hit.position;
        previous_normal_ = light_normal_;
        medium_ = medium_beyond(shape, hit, wi, medium_);
        ray_.origin = Geometry::offset_origin(hit, wi);
        ray_.direction = wi;
        ray_.t_max = kInfinity;
        return true;
    }

    /// Russian roulette by the throughput without the factors that refraction and the guide put on
    /// it.
    bool survives() {
        const float carried = max_component(beta_) * roulette_scale_;
        if (!(carried < 1) || depth_ <= 1) return true;
        const float end = std::max(0.0f, 1 - carried);
        if (sampler_.next_1d() < end) return false;
        beta_ *= 1 / (1 - end);
        return true;
    }

    const RenderScene& scene_;
    Ray ray_;
    Sampler& sampler_;
    const int max_depth_;
    PathRecord* const record_;
    const Vec3 camera_position_;

    PathResult result_;
    Rgb beta_{1};
    float pdf_ = 0;  // of the last sampled direction
    bool specular_ =
        true;  // the last lobe (the camera counts as one): no light sampling could find it
    bool sharp_so_far_ = true;
    float sharp_probability_ = 1;  // of the specular lobes that were chosen, while sharp so far
    float roulette_scale_ = 1;
    MediumId medium_ = -1;
    int passed_interfaces_ = 0;
    int depth_ = 0;       ///< scattering events so far
    float glow_ = 0;      ///< luminance from media since the last vertex, for the record
    Vec3 camera_origin_;  ///< where the path starts
    GuideMixture guide_;  // at the current vertex
    Vec3 light_normal_;   // what the lights are told at the current vertex
    Vec3 previous_position_, previous_normal_;  // and at the last one, for the weights
};

}  // namespace

PathResult trace_path(const RenderScene& scene, Ray ray, Sampler& sampler, int max_depth,
                      PathRecord* record) {
    return PathTracer(scene, ray, sampler, max_depth, record).run();
}

}  // namespace covtrace
