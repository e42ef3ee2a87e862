#include "integrator/path.h"

#include <cmath>

#include "shading/normal_map.h"

namespace covtrace {

namespace {

float power_heuristic(float a, float b) {
    if (std::isinf(a)) return 1;
    const float a2 = a * a, b2 = b * b;
    return a2 + b2 > 0 ? a2 / (a2 + b2) : 0;
}

Rgb transmittance(const RenderScene& scene, MediumId medium, float distance) {
    if (medium < 0) return Rgb(1);
    const Rgb sigma = scene.extinction[static_cast<size_t>(medium)];
    const auto pass = [distance](float s) { return s > 0 ? std::exp(-s * distance) : 1.0f; };
    return {pass(sigma.r), pass(sigma.g), pass(sigma.b)};
}

bool transmits(const Bsdf& bsdf) {
    return std::holds_alternative<DielectricBsdf>(bsdf) ||
           std::holds_alternative<DiffuseTransmissionBsdf>(bsdf) ||
           std::holds_alternative<ThinDielectricBsdf>(bsdf);
}

/// The medium that a ray is in after it leaves `hit` in the direction `w`.
MediumId medium_beyond(const PlacedShape& shape, const SurfaceHit& hit, Vec3 w, MediumId current) {
    const ShapeDescription& d = shape.description;
    if (d.inside == d.outside) return current;
    return dot(w, hit.ng) < 0 ? d.inside : d.outside;
}

/// One path in the making. The estimate is  sum over vertices of  beta * (emission + direct light),
/// beta = product of  f |cos| / pdf  so far; each kind of light is found by two strategies whose
/// weights add to one.
class PathTracer {
  public:
    PathTracer(const RenderScene& scene, Ray ray, Sampler& sampler, int max_depth,
               PathRecord* record)
        : scene_(scene),
          ray_(ray),
          sampler_(sampler),
          max_depth_(max_depth),
          record_(record),
          camera_position_(ray.origin) {}

    PathResult run() {
        if (record_) {
            record_->clear();
            record_->camera_ray = ray_;
        }
        for (int depth = 0;;) {
            SurfaceHit hit;
            ++result_.rays;
            if (!scene_.geometry.intersect(ray_, hit)) {
                escape();
                break;
            }
            beta_ *= transmittance(scene_, medium_, hit.t);
            const PlacedShape& shape = scene_.geometry.shapes()[hit.shape];
            const MaterialId material =
                scene_.materials.at(shape.description.material, hit, scene_.textures);
            const Bsdf bsdf = scene_.materials.bsdf(material, hit, scene_.textures);
            if (std::holds_alternative<InterfaceBsdf>(bsdf)) {
                medium_ = medium_beyond(shape, hit, ray_.direction, medium_);
                ray_.origin = Geometry::offset_origin(hit, ray_.direction);
                if (++passed_interfaces_ > kMostInterfaces) break;
                continue;
            }
            ++result_.vertices;
            const Vec3 wo = -ray_.direction;
            PathVertex* vertex = begin_vertex(hit, material, wo);
            add_emission(hit, wo, vertex);
            const Frame frame = frame_at(hit, shape, material);
            const Vec3 wo_local = frame.to_local(wo);
            if (depth == 0) describe_first_hit(hit, frame.z, wo, bsdf, wo_local);
            if (vertex) vertex->shading = frame;
            if (depth++ == max_depth_) break;
            sampler_.set_dimension(depth * kPairsPerBounce);
            const Vec2 u_choice = sampler_.next_2d();
            const Vec2 u_light = sampler_.next_2d(), u_bsdf = sampler_.next_2d();
            // Lights are chosen for the side that can be lit: the viewer's, or both where light
            // passes through.
            light_normal_ = transmits(bsdf) ? Vec3{} : face_forward(frame.z, wo);
            guide_ = has_diffuse_lobe(bsdf) && depth < max_depth_
                         ? scene_.guide.at(hit.position, light_normal_)
                         : GuideMixture{};
            if (!is_specular(bsdf))
                add_direct(hit, shape, bsdf, frame, wo_local, u_choice.x, u_light, vertex);
            if (!scatter(hit, shape, bsdf, frame, wo_local, u_choice.y, u_bsdf, vertex)) break;
            if (!survives(depth)) break;
        }
        return result_;
    }

  private:
    static constexpr int kPairsPerBounce = 4;
    static constexpr int kMostInterfaces =
        1000;  // a ray caught between coincident interfaces must end

    void escape() {
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
        if (record_ && record_->count == static_cast<int>(result_.vertices)) {
            record_->escaped = luminance(contribution);
            record_->escape_direction = ray_.direction;
            record_->escape_seen_sharply = sharp_so_far_;
        }
    }

    PathVertex* begin_vertex(const SurfaceHit& hit, MaterialId material, Vec3 wo) {
        if (!record_ || record_->count == PathRecord::kCapacity) return nullptr;
        PathVertex* v = &record_->vertices[static_cast<size_t>(record_->count++)];
        v->hit = hit;
        v->wo = wo;
        v->material = material;
        v->emitted = v->direct = 0;
        v->scatters = false;
        v->seen_sharply = sharp_so_far_;
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
        if (vertex) vertex->emitted = luminance(contribution);
    }

    /// The frame of the BSDF, with the material's bump or normal map.
    Frame frame_at(const SurfaceHit& hit, const PlacedShape& shape, MaterialId material) const {
        if (!scene_.materials.has_normal_map(material)) return shading_frame(hit);
        // A step as pbrt takes it for 64 samples per pixel and more: an eighth of half a pixel.
        const float footprint =
            scene_.camera.half_pixel(distance(camera_position_, hit.position)) / 8;
        const DifferentialGeometry base = scene_.geometry.differential(hit);
        return NormalMap(scene_.materials.description(material), scene_.textures, shape, hit, base,
                         footprint)
            .frame();
    }

    void describe_first_hit(const SurfaceHit& hit, Vec3 normal, Vec3 wo, const Bsdf& bsdf,
                            Vec3 wo_local) {
        result_.hit = true;
        result_.albedo = albedo(bsdf, wo_local);
        result_.normal = face_forward(normal, wo);
        result_.depth = distance(ray_.origin, hit.position);
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
        shadow.direction = light->wi;
        if (std::isfinite(light->distance)) {
            // Aim at the light from the moved origin and stop just short of it.
            const Vec3 to_light = light->position - shadow.origin;
            const float d = length(to_light);
            if (!(d > 0)) return;
            shadow.direction = to_light / d;
            shadow.t_max = d * (1 - 1e-4f);
        }
        ++result_.rays;
        if (scene_.geometry.occluded(shadow)) return;
        const MediumId medium = medium_beyond(shape, hit, light->wi, medium_);
        const float weight =
            light->is_delta
                ? 1.0f
                : power_heuristic(light->pdf, direction_pdf(bsdf, wo_local, wi_local, light->wi));
        const Rgb contribution = beta_ * f * light->radiance *
                                 transmittance(scene_, medium, light->distance) *
                                 (weight / light->pdf);
        result_.radiance += contribution;
        if (!vertex) return;
        vertex->direct = luminance(contribution);
        vertex->light = *light;
        vertex->direct_event = {light->wi, lobe_shares(bsdf, wo_local, wi_local)};
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
    bool survives(int depth) {
        const float carried = max_component(beta_) * roulette_scale_;
        if (!(carried < 1) || depth <= 1) return true;
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
    float roulette_scale_ = 1;
    MediumId medium_ = -1;
    int passed_interfaces_ = 0;
    GuideMixture guide_;                        // at the current vertex
    Vec3 light_normal_;                         // what the lights are told at the current vertex
    Vec3 previous_position_, previous_normal_;  // and at the last one, for the weights
};

}  // namespace

PathResult trace_path(const RenderScene& scene, Ray ray, Sampler& sampler, int max_depth,
                      PathRecord* record) {
    return PathTracer(scene, ray, sampler, max_depth, record).run();
}

}  // namespace covtrace
