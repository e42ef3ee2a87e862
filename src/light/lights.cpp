#include "light/lights.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "geometry/leave_surface.h"
#include "light/directed.h"
#include "light/lights_impl.h"
#include "light/weight.h"

namespace covtrace {
namespace {

Emitter make_emitter(const Geometry& geometry, uint32_t shape) {
    const auto& form = geometry.shapes()[shape].description.geometry;
    if (std::holds_alternative<Sphere>(form) || std::holds_alternative<Disk>(form))
        return EmissiveQuadric(geometry, shape);
    return EmissiveMesh(geometry, shape);
}

double total_area(const Emitter& emitter) {
    return std::visit(
        [](const auto& e) {
            double sum = 0;
            for (int k = 0; k < e.light_count(); ++k) sum += double(e.area(k));
            return sum;
        },
        emitter);
}

/// Key of the light that shapes belong to: those with equal keys share its power. They come from
/// one directive, as a mesh file's triangles and quads do.
using LightKey = std::tuple<int, int, size_t>;
LightKey light_key(const std::vector<PlacedShape>& shapes, size_t i) {
    const ShapeDescription& s = shapes[i].description;
    return {s.area_light, s.directive, s.directive < 0 ? i : 0};
}

/// Radiant exitance of a diffuse light: its power per unit of area.
Rgb exitance(Rgb radiance, bool two_sided) {
    return (two_sided ? 2 * kPi : kPi) * radiance;
}

/// Whether alpha hides the whole shape, which is the customary way to write an invisible light.
bool is_hidden(const SceneDescription& scene, TextureId alpha) {
    if (alpha < 0) return false;
    const auto* constant =
        std::get_if<ConstantTexture>(&scene.textures[static_cast<size_t>(alpha)].value);
    return constant && constant->value.r == 0;
}

/// Rays that find a light: to the camera's a holdout is no light, but what lets them pass is one.
RayKinds kinds_that_find(const ShapeDescription& s, const AreaLightDescription& light) {
    const bool is_hole = s.is_holdout && !light.lets_light_pass;
    return is_hole ? static_cast<RayKinds>(s.visible_to & ~set_of(RayKind::camera)) : s.visible_to;
}

}  // namespace

Lights::Impl::Impl(const SceneDescription& scene, const Geometry& scene_geometry,
                   const TextureStore* scene_textures)
    : geometry(&scene_geometry), textures(scene_textures) {
    const std::vector<PlacedShape>& shapes = geometry->shapes();
    area_light_of_shape.assign(shapes.size(), -1);
    std::vector<LightBounds> finite;
    std::vector<std::optional<Emitter>> emitters(shapes.size());
    std::map<LightKey, double> areas;
    for (size_t i = 0; i < shapes.size(); ++i) {
        if (shapes[i].description.area_light < 0 || shapes[i].is_instanced) continue;
        emitters[i] = make_emitter(*geometry, static_cast<uint32_t>(i));
        areas[light_key(shapes, i)] += total_area(*emitters[i]);
    }
    for (size_t i = 0; i < shapes.size(); ++i) {
        if (!emitters[i]) continue;
        const ShapeDescription& shape = shapes[i].description;
        const AreaLightDescription& light =
            scene.area_lights[static_cast<size_t>(shape.area_light)];
        AreaLight area{.shape = static_cast<uint32_t>(i),
                       .radiance = light.radiance,
                       .two_sided = light.two_sided,
                       .image = textures ? light.image : -1,
                       .alpha = -1,
                       .is_visible = !is_hidden(scene, shape.alpha),
                       .visible_to = kinds_that_find(shape, light),
                       .first_light = static_cast<int>(owner.size()),
                       .emitter = std::move(*emitters[i])};
        // A light that is hidden altogether shines as if it had no alpha.
        if (textures && area.is_visible) area.alpha = shape.alpha;
        area.mean_factor = area.image < 0 ? Rgb(1) : textures->mean(area.image);
        if (light.power) {
            const float measured =
                static_cast<float>(areas.at(light_key(shapes, i))) *
                luminance(exitance(area.radiance * area.mean_factor, area.two_sided));
            area.radiance *= normalisation(*light.power, measured);
        }
        Rgb choice_factor = area.mean_factor;
        if (area.alpha >= 0) {
            // The mean of alpha over (u, v) may be 0 although some of the shape shines, where alpha
            // depends on the place in the world. A twentieth takes little from the other lights.
            constexpr float kLeast = 0.05f;
            // Alpha that is not a number becomes 0.
            const float alpha = std::min(1.0f, std::max(0.0f, textures->mean(area.alpha).r));
            area.mean_factor *= alpha;
            choice_factor *= std::max(alpha, kLeast);
        }
        direct(area, light, shape, warnings);
        choice_factor *= mean_over_directions(area);
        if (!note_kinds(area.visible_to)) choice_factor = {};
        std::visit(
            [&](const auto& emitter) {
                for (int k = 0; k < emitter.light_count(); ++k) {
                    LightBounds bounds = emitter.bounds(k);
                    bounds.intensity *= choice_weight(area.radiance * choice_factor);
                    bounds.two_sided = bounds.two_sided || light.two_sided;
                    if (area.cone) narrow(bounds, area);
                    finite.push_back(bounds);
                    owner.push_back(static_cast<uint32_t>(area_lights.size()));
                }
            },
            area.emitter);
        area_light_of_shape[i] = static_cast<int>(area_lights.size());
        area_lights.push_back(std::move(area));
    }
    for (const LightDescription& light : scene.lights) add_light(light);
    for (const PointEmitter& point : points) finite.push_back(bounds(point));
    tree = LightTree(finite);
}

void Lights::Impl::add_light(const LightDescription& light) {
    if (const auto* point = std::get_if<PointLight>(&light.value))
        points.push_back(make_point_emitter(*point, light.light_to_world));
    else if (const auto* spot = std::get_if<SpotLight>(&light.value))
        points.push_back(make_point_emitter(*spot, light.light_to_world));
    else if (const auto* round = std::get_if<GoniometricLight>(&light.value))
        points.push_back(make_point_emitter(*round, light.light_to_world, light.where, warnings));
    else if (const auto* slide = std::get_if<ProjectionLight>(&light.value))
        points.push_back(make_point_emitter(*slide, light.light_to_world, light.where, warnings));
    else if (const auto* distant = std::get_if<DistantLight>(&light.value))
        add_distant(*distant, light.light_to_world);
    else
        add_environment(std::get<InfiniteLight>(light.value), light);
}

bool Lights::Impl::note_kinds(RayKinds visible_to) {
    const RayKinds scattered = visible_to & kScatteredRays;
    kinds_differ = kinds_differ || (scattered != 0 && scattered != kScatteredRays);
    return scattered != 0;
}

void Lights::Impl::add_environment(const InfiniteLight& light, const LightDescription& placed) {
    environments.emplace_back(light, placed.light_to_world, placed.where, warnings);
    environment_visible_to.push_back(light.visible_to);
    note_kinds(light.visible_to);
}

void Lights::Impl::add_distant(const DistantLight& light, const Transform& light_to_world) {
    if (!DistantDisc::has_extent(light)) {
        distants.push_back(make_distant_emitter(light, light_to_world));
        return;
    }
    environments.emplace_back(light, light_to_world);
    environment_visible_to.push_back(light.visible_to);
    note_kinds(light.visible_to);
}

std::optional<LightSample> Lights::Impl::sample_area(int light, float probability, Vec3 p,
                                                     float time, Vec2 u) const {
    const AreaLight& area = area_lights[owner[static_cast<size_t>(light)]];
    const int local = light - area.first_light;
    const auto point =
        std::visit([&](const auto& e) { return e.sample(local, p, time, u); }, area.emitter);
    if (!point || (!area.two_sided && !(dot(point->normal, point->wi) < 0))) return std::nullopt;
    LightSample s;
    s.wi = point->wi;
    s.distance = dot(point->position - p, point->wi);
    s.radiance = area.radiance;
    if (area.varies()) {
        const TexturePoint at = std::visit(
            [&](const auto& e) { return texture_point(e, local, *point, time); }, area.emitter);
        s.radiance = radiance_at(area, at, point->normal, -point->wi);
        if (area.alpha >= 0) s.radiance *= clamp01(textures->eval_float(area.alpha, at));
        if (is_black(s.radiance)) return std::nullopt;
    }
    s.radiance *= softened(area, p, time);
    s.pdf = probability * point->pdf;
    s.light = light;
    s.position = off_surface(point->unrounded, point->normal, point->error, -point->wi);
    s.normal = point->normal;
    s.visible_to = area.visible_to;
    if (!area.is_visible) {
        // An invisible light, which no ray finds, acts as a delta light of the same irradiance.
        s.is_delta = true;
        s.radiance *= 1 / point->pdf;
        s.pdf = probability;
    }
    return s;
}

std::optional<LightSample> Lights::Impl::sample_finite(int light, float probability, Vec3 p,
                                                       float time, Vec2 u) const {
    return light < first_point() ? sample_area(light, probability, p, time, u)
                                 : sample_point(light, probability, p);
}

std::optional<LightSample> Lights::Impl::sample_point(int light, float probability, Vec3 p) const {
    const PointEmitter& point = points[static_cast<size_t>(light - first_point())];
    const Vec3 to_light = point.position - p;
    const float distance_squared = length_squared(to_light);
    if (!(distance_squared > 0)) return std::nullopt;
    LightSample s;
    s.distance = std::sqrt(distance_squared);
    s.wi = to_light / s.distance;
    s.radiance = intensity(point, -s.wi) * (1 / distance_squared);
    if (is_black(s.radiance)) return std::nullopt;
    s.pdf = probability;
    s.is_delta = true;
    s.light = light;
    s.position = point.position;
    return s;
}

Rgb Lights::Impl::radiance_at(const AreaLight& area, const TexturePoint& at, Vec3 n, Vec3 w) const {
    Rgb share = area.layers < 0 ? Rgb(1) : emission_share(area.layers, at, std::abs(dot(n, w)));
    if (area.cone) share *= area.cone->falloff(w);
    if (area.directions) share *= (*area.directions)(w);
    const Rgb radiance = share * area.radiance;
    return area.image < 0 ? radiance : radiance * textures->eval(area.image, at);
}

const AreaLight* Lights::Impl::area_light_of(const SurfaceHit& hit) const {
    const int index = area_light_of_shape[hit.shape];
    return index < 0 ? nullptr : &area_lights[static_cast<size_t>(index)];
}

Lights::Lights(const SceneDescription& scene, const Geometry& geometry,
               const TextureStore* textures)
    : impl_(std::make_unique<Impl>(scene, geometry, textures)) {}
Lights::~Lights() = default;

void Lights::set_layers(const std::function<bool(MaterialId)>& has_layers, EmissionShare share) {
    impl_->emission_share = std::move(share);
    for (AreaLight& area : impl_->area_lights) {
        const MaterialId material = impl_->geometry->shapes()[area.shape].description.material;
        area.layers = material >= 0 && has_layers(material) ? material : -1;
    }
}

const Warnings& Lights::warnings() const {
    return impl_->warnings;
}

bool Lights::draws_ahead() const {
    return impl_->infinite_count() == 1 && has_environment() && impl_->environments[0].is_map();
}

Lights::Draw Lights::begin_draw(Vec2 u) const {
    Draw draw{u, {}, 0};
    if (draws_ahead()) impl_->advance(impl_->environments[0], draw, 1);
    return draw;
}

void Lights::continue_draw(Draw& draw) const {
    if (draws_ahead()) impl_->advance(impl_->environments[0], draw, 2);
}

std::optional<LightSample> Lights::finish_draw(Vec3 p, Vec3 n, float time, float u_select,
                                               Draw draw, const SkyCell* cell,
                                               LightTree::Factors factors, bool looks_later) const {
    const InfiniteShare share = impl_->infinite_share(p, n);
    if (u_select < share.probability)
        return impl_->sample_infinite(share, p, n, u_select / share.probability, draw, cell,
                                      looks_later);
    const float finite = 1 - share.probability;
    if (!(finite > 0)) return std::nullopt;
    const float u_tree = std::min((u_select - share.probability) / finite, kLargestBelowOne);
    const auto choice = impl_->tree.sample(p, n, u_tree, factors);
    if (!choice) return std::nullopt;
    return impl_->sample_finite(choice->light, finite * choice->probability, p, time, draw.u);
}

void Lights::try_finite(Vec3 p, Vec3 n, float time, float u_select, Vec2 u, Trial& trial) const {
    trial.sample.reset();
    const auto choice = impl_->tree.explore(p, n, u_select, trial.way);
    if (!choice) return;
    trial.sample = impl_->sample_finite(choice->light, choice->probability, p, time, u);
    if (trial.sample) trial.place_pdf = trial.sample->pdf / choice->probability;
}

size_t Lights::factor_count() const {
    return impl_->first_distant() > 1 ? impl_->tree.factor_count() : 0;
}

Rgb Lights::emitted(const SurfaceHit& hit, Vec3 wo, float distance) const {
    const AreaLight* area = impl_->area_light_of(hit);
    if (!area || !area->is_visible || (!area->two_sided && !(dot(hit.ng, wo) > 0))) return {};
    return impl_->softened(*area, hit.position + wo * distance, hit.time) *
           impl_->radiance_at(*area, {hit.uv, hit.position, {}, hit.ng, hit.vertices(), hit.facing},
                              hit.ng, wo);
}

float Lights::pdf(Vec3 p, Vec3 n, Vec3 wi, const SurfaceHit& hit,
                  LightTree::Factors factors) const {
    const AreaLight* area = impl_->area_light_of(hit);
    if (!area || !area->is_visible || (!area->two_sided && !(dot(hit.ng, wi) < 0))) return 0;
    return std::visit(
        [&](const auto& e) {
            const int local = e.light_of(hit);
            const float probability =
                selection_probability(p, n, area->first_light + local, factors);
            return probability > 0 ? probability * e.pdf(local, p, hit) : 0.0f;
        },
        area->emitter);
}

float Lights::selection_probability(Vec3 p, Vec3 n, int light, LightTree::Factors factors) const {
    const InfiniteShare share = impl_->infinite_share(p, n);
    if (light < impl_->first_distant())
        return (1 - share.probability) * impl_->tree.probability(p, n, light, factors);
    if (!(share.probability > 0)) return 0;
    const auto i = static_cast<size_t>(light - impl_->first_distant());
    return share.probability * impl_->infinite_weight(share, i, p, n) / share.weight;
}

bool Lights::has_environment() const {
    return !impl_->environments.empty();
}
bool Lights::has_sky() const {
    return std::any_of(impl_->environments.begin(), impl_->environments.end(),
                       [](const Environment& e) { return !e.disc(); });
}
bool Lights::has_sky_for(RayKind kind) const {
    for (size_t i = 0; i < impl_->environments.size(); ++i)
        if (!impl_->environments[i].disc() && contains(impl_->environment_visible_to[i], kind))
            return true;
    return false;
}
bool Lights::is_in_disc(Vec3 w) const {
    return std::any_of(impl_->environments.begin(), impl_->environments.end(),
                       [w](const Environment& e) { return e.disc() && e.disc()->contains(w); });
}
Rgb Lights::environment(Vec3 p, Vec3 w, RayKind kind) const {
    return impl_->environment(p, w, kind);
}
bool Lights::kinds_differ() const {
    return impl_->kinds_differ;
}
Lights::Sky Lights::sky(Vec3 p, Vec3 n, Vec3 w, const SkyCell* cell, RayKind kind) const {
    return impl_->sky(impl_->infinite_share(p, n), p, n, w, cell, kind);
}
std::vector<DistantView> Lights::distant_views() const {
    std::vector<DistantView> views;
    for (const AreaLight& area : impl_->area_lights) {
        if (!area.is_visible) continue;
        DistantView view;
        view.visible_to = area.visible_to;
        view.cone = area.cone;
        view.directions = area.directions;
        view.radiance = luminance(area.radiance * area.mean_factor);
        std::visit(
            [&](const auto& emitter) {
                for (int k = 0; k < emitter.light_count(); ++k) {
                    const LightBounds bounds = emitter.bounds(k);
                    view.box.extend(bounds.box.lo);
                    view.box.extend(bounds.box.hi);
                    view.intensity += bounds.intensity * view.radiance;
                }
            },
            area.emitter);
        views.push_back(view);
    }
    return views;
}

Rgb Lights::total_power() const {
    Rgb sum;
    for (const AreaLight& area : impl_->area_lights)
        if ((area.visible_to & kScatteredRays) != 0)
            sum += static_cast<float>(total_area(area.emitter)) * share_let_through(area) *
                   exitance(area.radiance * area.mean_factor, area.two_sided);
    for (const PointEmitter& point : impl_->points) sum += power(point);
    const float radius = impl_->geometry->bounds().radius();
    for (const DistantEmitter& d : impl_->distants) sum += kPi * sqr(radius) * d.irradiance;
    for (size_t i = 0; i < impl_->environments.size(); ++i)
        if ((impl_->environment_visible_to[i] & kScatteredRays) != 0)
            sum += impl_->environments[i].power(radius);
    return sum;
}
int Lights::count() const {
    return impl_->first_environment() + static_cast<int>(impl_->environments.size());
}

}  // namespace covtrace
