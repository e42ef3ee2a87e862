#include "integrator/path.h"

#include <cmath>

#include "bsdf/models.h"
#include "integrator/path_tracer.h"
#include "shading/normal_map.h"
#include "shading/reflecting_normal.h"
#include "shading/strand.h"

namespace covtrace {

namespace {

bool transmits(const Bsdf& bsdf) {
    if (const auto* layered = std::get_if<LayeredBsdf>(&bsdf)) return transmits(base_of(*layered));
    return std::holds_alternative<DielectricBsdf>(bsdf) ||
           std::holds_alternative<DiffuseTransmissionBsdf>(bsdf) ||
           std::holds_alternative<HairBsdf>(bsdf) ||
           std::holds_alternative<ThinDielectricBsdf>(bsdf);
}

/// Whether the model loses light that it mirrors to below the surface.
bool loses_mirrored_light(const Bsdf& bsdf) {
    return has_sharp_lobe(bsdf) && !transmits(bsdf);
}

}  // namespace

const Ray& PathTracer::next_ray() {
    ++(depth_ == 0 ? result_.rays.camera : result_.rays.bounce);
    // Begin the light sampling of the vertex to come; it uses that vertex' second pair of numbers
    if (draws_ahead_) light_draw_ = scene_.lights.begin_draw(sampler_.pair(pairs_to_come() + 1));
    return ray_;
}

uint32_t PathTracer::pairs_to_come() const {
    return body_ ? kBodyPairs + steps_in_bodies_ * kPairsPerBodyStep
                 : static_cast<uint32_t>(depth_ + 1) * kPairsPerBounce;
}

void PathTracer::prefetch(bool found) {
    if (!found)
        scene_.lights.prefetch_environment(ray_.direction);
    else if (draws_ahead_)
        scene_.lights.continue_draw(light_draw_);
}

bool PathTracer::meet(bool found) {
    if (body_) return cross_body(found);
    const SurfaceHit& hit = hit_;
    // Cross the medium, which may scatter the path before it gets there
    if (is_in_medium()) {
        const float length = found ? hit.t : scene_.unbounded_distance;
        const MediumEvent event = cross_medium(length);
        if (looks_straight())
            clear_ *= event.through ? *event.through : transmittance(scene_, medium_, ray_, length);
        if (event.scatters) {
            if (looks_straight()) tell_opacity_behind(found);
            return scatter_in_medium(event.distance);
        }
    }
    if (!found) {
        escape();
        return false;
    }
    const PlacedShape& shape = scene_.geometry.shapes()[hit.shape];
    if (shape.lets_light_pass) {
        pass_emitter(hit, shape);
        return pass(hit, shape);
    }
    if (sharp_so_far_ && is_unseen_back(shape, hit, ray_.direction)) return pass(hit, shape);
    const PlacedMaterial material =
        scene_.materials.at(shape.description.material, hit, scene_.textures);
    Bsdf bsdf = bsdf_at(hit, material.id);
    place_on_strand(bsdf, hit, shape.description.tube_sides, -ray_.direction);
    if (shape.description.is_holdout && looks_straight() &&
        !std::holds_alternative<InterfaceBsdf>(bsdf)) {
        end_at_holdout();
        return false;
    }
    if (const auto* unlit = std::get_if<UnlitBsdf>(&bsdf)) {
        if (is_seen(*unlit, hit)) return see_unlit(*unlit, material.id);
    } else if (!std::holds_alternative<InterfaceBsdf>(bsdf)) {
        return meet_surface(hit, shape, material, bsdf);
    } else if (shape.description.area_light >= 0) {
        pass_emitter(hit, shape);  // a mix that shines lets light pass here
    }
    weigh(material.weight);
    return pass(hit, shape);
}

Bsdf PathTracer::bsdf_at(const SurfaceHit& hit, MaterialId material) const {
    // Textures are filtered as in pbrt at 64 samples per pixel and more, wherever the path has
    // been: over an eighth of the pixel's width at the straight distance from the eye, so that the
    // filter of the texture adds next to nothing to that of the pixel
    const Vec3 from_eye = hit.position - camera_origin_;
    const float away = length(from_eye);
    const Lobes lobes =
        scene_.description.regularizes && !sharp_so_far_ ? Lobes::regularized : Lobes::as_given;
    if (!(away > 0)) return scene_.materials.bsdf(material, hit, scene_.textures, {}, 0, lobes);
    return scene_.materials.bsdf(material, hit, scene_.textures, from_eye / away,
                                 scene_.camera.half_pixel(away) / 4, lobes);
}

bool PathTracer::pass(const SurfaceHit& hit, const PlacedShape& shape) {
    medium_ = medium_beyond(shape, hit, ray_.direction, medium_);
    ray_.origin = Geometry::offset_origin(hit, ray_.direction);
    return ++passed_interfaces_ <= kMostInterfaces;
}

void PathTracer::weigh(float weight) {
    beta_ *= weight;
    weighed_ *= weight;
    colourless_beta_ *= weight;
    clear_ *= weight;
}

void PathTracer::pass_emitter(const SurfaceHit& hit, const PlacedShape& shape) {
    const Vec3 wo = -ray_.direction;
    if (is_black(scene_.lights.emitted(hit, wo))) return;
    PathVertex* vertex = begin_vertex(hit, -1, wo);
    add_emission(hit, wo, vertex);
    if (!vertex) return;
    vertex->material = shape.description.material;
    vertex->shading = shading_frame(hit);
    vertex->scatters = true;
    vertex->next_event.wi = ray_.direction;
    vertex->next_event.lobes.count = 1;
    vertex->next_event.lobes.lobes[0] = {LobeKind::specular_transmission, Rgb(1)};
}

bool PathTracer::is_seen(const UnlitBsdf& unlit, const SurfaceHit& hit) const {
    return sharp_so_far_ && (unlit.two_sided || dot(ray_.direction, hit.ng) < 0);
}

bool PathTracer::see_unlit(const UnlitBsdf& unlit, MaterialId material) {
    const Vec3 wo = -ray_.direction;
    PathVertex* vertex = begin_vertex(hit_, -1, wo);
    const Vec3 normal = face_forward(hit_.ns, wo);
    describe_vertex(hit_.position, albedo(unlit, normal), normal);
    if (depth_ == 0) describe_first(hit_, wo);
    const Rgb contribution = beta_ * unlit.colour;
    result_.radiance += contribution;
    if (in_view()) result_.in_view += contribution;
    if (vertex) {
        vertex->material = material;
        vertex->shading = shading_frame(hit_);
        vertex->emitted = luminance(contribution);
    }
    return false;
}

bool PathTracer::meet_surface(const SurfaceHit& hit, const PlacedShape& shape,
                              PlacedMaterial placed, Bsdf& bsdf) {
    const Vec3 wo = -ray_.direction;
    const MaterialId material = placed.id;
    // Add light that the surface emits
    PathVertex* vertex = begin_vertex(hit, -1, wo);
    if (vertex) vertex->material = material;
    add_emission(hit, wo, vertex);
    weigh(placed.weight);
    if (auto* glass = std::get_if<DielectricBsdf>(&bsdf); glass && glass->dispersion)
        disperse(*glass);
    const Frame unturned = frame_at(hit, shape, material);
    const Frame frame = reflecting_frame(unturned, hit, bsdf, wo);
    if (scene_.materials.turns_clearcoat(material))
        turn_clearcoat(bsdf, hit, shape, material, frame, wo);
    const Surface surface{hit, shape, bsdf, frame, frame.to_local(wo)};
    // Describe the surface to filters and denoisers, by its smooth normal
    if (seen_clearly_)
        describe_vertex(hit.position, albedo(bsdf, surface.wo), face_forward(unturned.z, wo));
    if (depth_ == 0) describe_first(hit, wo);
    if (vertex) {
        vertex->shading = frame;
        vertex->is_turned = frame.z != unturned.z;
    }
    if (depth_++ == max_depth_) return false;
    sampler_.set_dimension(static_cast<uint32_t>(depth_) * kPairsPerBounce);
    // Choose the side that lights are sampled for: the viewer's, or both where light passes through
    const Vec3 normal = transmits(bsdf) ? Vec3{} : face_forward(frame.z, wo);
    return light_and_scatter(surface, normal, vertex);
}

bool PathTracer::light_and_scatter(const Surface& surface, Vec3 normal, PathVertex* vertex) {
    const SurfaceHit& hit = surface.hit;
    const Bsdf& bsdf = surface.bsdf;
    const auto [u_choice, u_light, u_scatter, u_roulette] = sampler_.next_four_2d();
    lit_ = {hit.position, normal};
    guide_ = has_diffuse_lobe(bsdf) && depth_ < max_depth_ ? caustic_guide_.at(hit.position, normal)
                                                           : GuideMixture{};
    const bool finds_lights = !is_specular(bsdf), is_led = finds_lights && normal != Vec3{};
    if (is_led && sky_guide_) lit_.sky_cell = sky_guide_->at(hit.position, normal);
    if (is_led && lamp_guide_) lit_.lamp_factors = lamp_guide_->at(hit.position, normal);
    const bool may_learn = normal != Vec3{} && has_diffuse_lobe(bsdf);
    path_mixture_ = path_guide_ && may_learn && depth_ < max_depth_
                        ? path_guide_->at({hit.position, normal})
                        : PathGuideMixture{};
    if (vertex) {
        vertex->is_specular = is_specular(bsdf);
        if (may_learn) vertex->guided_normal = normal;
    }
    // Sample direct illumination, then the direction in which the path goes on
    if (finds_lights) {
        add_direct(surface, u_choice.x, u_light, u_roulette.y, vertex);
        if (samples_by_mirrors_ && depth_ < max_depth_) add_mirrored_light(surface, vertex);
    }
    const bool goes_on =
        scatter(surface, u_choice.y, u_scatter, u_roulette.y, vertex) && survives(u_roulette.x);
    if (vertex && goes_on) vertex->carried_on = luminance(beta_);
    return goes_on;
}

Frame PathTracer::frame_at(const SurfaceHit& hit, const PlacedShape& shape,
                           MaterialId material) const {
    if (!scene_.materials.turns_frame(material)) return shading_frame(hit);
    return mapped_frame(hit, shape, scene_.materials.description(material), MappedLayer::surface);
}

Frame PathTracer::reflecting_frame(const Frame& unturned, const SurfaceHit& hit, const Bsdf& bsdf,
                                   Vec3 wo) {
    const Vec3 normal = reflecting_normal(unturned.z, hit.ng, wo);
    const bool stays = normal == unturned.z || !loses_mirrored_light(bsdf);
    return stays ? unturned : Frame::from_z_x(normal, unturned.x);
}

void PathTracer::turn_clearcoat(Bsdf& bsdf, const SurfaceHit& hit, const PlacedShape& shape,
                                MaterialId material, const Frame& frame, Vec3 wo) const {
    auto* layered = std::get_if<LayeredBsdf>(&bsdf);
    if (!layered) return;
    const MaterialDescription& description = scene_.materials.description(material);
    Vec3 normal = description.clearcoat->normal_map >= 0
                      ? mapped_frame(hit, shape, description, MappedLayer::clearcoat).z
                      : hit.ns;
    if (loses_mirrored_light(bsdf)) normal = reflecting_normal(normal, hit.ng, wo);
    layered->coat.normal = frame.to_local(normal);
}

Frame PathTracer::mapped_frame(const SurfaceHit& hit, const PlacedShape& shape,
                               const MaterialDescription& material, MappedLayer layer) const {
    // The step of the map's differences is as long as pbrt's for 64 samples per pixel and more: an
    // eighth of half a pixel.
    const float footprint = scene_.camera.half_pixel(distance(camera_origin_, hit.position)) / 8;
    const DifferentialGeometry base = scene_.geometry.differential(hit);
    return NormalMap(material, scene_.textures, shape, hit, base, footprint, layer).frame();
}

PathVertex* PathTracer::begin_vertex(const SurfaceHit& hit, MediumId medium, Vec3 wo) {
    ++result_.vertices;
    if (!record_ || record_->count == PathRecord::kCapacity) return nullptr;
    PathVertex* v = &record_->vertices[static_cast<size_t>(record_->count++)];
    v->hit = hit;
    v->medium = medium;
    v->wo = wo;
    v->material = -1;
    v->emitted = v->direct = v->mirrored = 0;
    v->scatters = v->is_turned = false;
    v->seen_sharply = sharp_so_far_;
    v->glow = glow_;
    glow_ = 0;
    v->in_view = in_view();
    v->carried = luminance(beta_);
    v->carried_on = v->next_value = v->next_bsdf_pdf = 0;
    v->is_specular = false;
    v->guided_normal = {};
    return v;
}

void PathTracer::describe_first(const SurfaceHit& hit, Vec3 wo) {
    result_.geometric_normal = face_forward(hit.ng, wo);
    result_.uv = hit.uv;
    result_.opacity = 1;
}

void PathTracer::describe_vertex(Vec3 position, Rgb albedo, Vec3 normal) {
    if (depth_ == 0) {
        result_.hit = true;
        result_.position = position;
        result_.albedo = albedo * weighed_;
        result_.normal = normal;
        result_.depth = travelled_ = distance(camera_origin_, position);
    } else {
        travelled_ += distance(lit_.position, position);
    }
    result_.features = {albedo * (has_wavelengths_colour_ ? colourless_beta_ : beta_), normal,
                        travelled_};
}

bool PathTracer::survives(float u) {
    // Long walks end at random: between surfaces that absorb nothing a path would go on for as many
    // bounces as it may, and a scene may allow a million. Beyond a thousand it goes on for a
    // hundred more in the mean.
    constexpr int kLongWalk = 1000;
    constexpr float kLeastEnd = 0.01f;
    // Throughput below which paths may end at random. Ending those that carry more would add more
    // noise than their rays are worth (docs/decisions/0075).
    constexpr float kWorthwhile = 0.25f;
    const float carried = max_component(beta_) * roulette_scale_ / kWorthwhile;
    const float least = depth_ > kLongWalk ? kLeastEnd : 0.0f;
    if (depth_ <= 1 || (!(carried < 1) && least == 0)) return true;
    const float end = std::max(least, 1 - carried);
    if (u < end) return false;
    beta_ *= 1 / (1 - end);
    return true;
}

}  // namespace covtrace
