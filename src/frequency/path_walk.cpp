#include "frequency/path_walk.h"

#include <cmath>

#include "frequency/scatter.h"

namespace covtrace {

namespace cov = covariance;

namespace {

/// The surface or medium at a vertex as an emitter, seen by a receiver at the given distance. Only
/// a diffuse surface has its own normal; what others reflect or transmit is taken to face the
/// receiver.
cov::Emitter<double> emitter_at(const PathVertex& v, double distance) {
    if (v.medium >= 0) return {{}, distance};  // a medium shines about evenly
    const LobeShares& lobes = v.scatters ? v.next_event.lobes : v.direct_event.lobes;
    const bool diffuse = lobes.count > 0 && (lobes.lobes[0].kind == LobeKind::diffuse_reflection ||
                                             lobes.lobes[0].kind == LobeKind::diffuse_transmission);
    return {diffuse ? v.hit.ns : v.wo, distance};
}

/// The outline of a surface as seen along `outgoing`; none where it turns away nowhere.
std::optional<OwnOutline> own_outline(const cov::Surface<double>& surface,
                                      const cov::Motion<double>& motion, Vec3 outgoing) {
    const auto contour = cov::contour<double>(surface, outgoing);
    if (!contour) return std::nullopt;
    return OwnOutline{*contour, motion};
}

/// Covariance over the sensor's coordinates, from the light field beside the camera as one that
/// rests would see it.
cov::SymmetricMatrix5<double> to_sensor(const LightField& at_rest, const SensorGeometry& g) {
    if (cov::trace(at_rest.sigma) == 0) return {};
    if (g.orthographic)
        return cov::sensor(at_rest, cov::OrthographicLens<double>{
                                        g.right, g.down, g.forward, g.focal_distance, g.lens_radius,
                                        g.pixels_per_x, g.pixels_per_y, g.shutter});
    return cov::sensor(
        at_rest, cov::ThinLens<double>{g.right, g.down, g.forward, g.focal_distance, g.lens_radius,
                                       g.pixels_per_x, g.pixels_per_y, g.shutter});
}

}  // namespace

void ArrivingLight::add(const LightField& other, double other_weight) {
    if (!(other_weight > 0)) return;
    if (weight > 0)
        *field = cov::merge(*field, weight, other, other_weight);
    else
        field.emplace(other);
    weight += other_weight;
}

void ArrivingLight::clear() {
    field.reset();
    weight = 0;
}

void ArrivingLight::add_glow(Vec3 travel, double glow) {
    if (glow > 0) add({{}, cov::frame_along<double>(travel)}, glow);
}

PathWalk::PathWalk(const ReplayedScene& context, const PathRecord& record, LightPart part,
                   double least)
    : context_(context),
      scene_(context.scene),
      spectra_(context.spectra),
      record_(record),
      part_(part),
      least_(least),
      total_(total()),
      camera_(scene_.camera.sensor(record.camera_ray)) {}

PathCovariance PathWalk::run() {
    if (!(total_ > 0)) return {};
    find_visibilities();
    arrive_from_sky();
    for (int i = record_.count - 1; i >= 0; --i) {
        std::optional<OwnOutline> own = scatter_at(i);
        emit_at(i, own);
        carry_on(i, own);
    }
    return at_sensor();
}

// ---- The steps of the walk

double PathWalk::total() const {
    double sum =
        double(taken(record_.escaped, record_.escape_in_view)) + taken(record_.escape_glow, false);
    for (int i = 0; i < record_.count; ++i) {
        const PathVertex& v = vertex(i);
        sum += double(taken(v.emitted, v.in_view)) + taken(v.direct, false) +
               taken(v.mirrored, false) + taken(v.glow, false);
    }
    return sum;
}

void PathWalk::find_visibilities() {
    // Follow the path from the camera: the view of a vertex shrinks with every rough surface before
    // it
    Vec3 previous = record_.camera_ray.origin;
    float travelled = 0;
    for (size_t i = 0; i < size_t(record_.count); ++i) {
        const PathVertex& v = record_.vertices[i];
        const float d = distance(previous, v.hit.position);
        travelled += d;
        ways_[i] = d;
        distances_[i] = travelled;
        previous = v.hit.position;
        if (context_.occluders)
            visible_[i] = i == 0 ? first_visibility(camera_, d, sharpest_window(v))
                                 : next_visibility(camera_, visible_[i - 1], d, sharpest_window(v));
        if (v.mirrored > 0) find_visibility_of_mirror(i);
    }
}

void PathWalk::find_visibility_of_mirror(size_t i) {
    const auto m = size_t(mirror(int(i)));
    const PathVertex& place = vertex(int(m));
    ways_[m] = distance(place.hit.position, record_.vertices[i].hit.position);
    distances_[m] = distances_[i] + ways_[m];
    if (context_.occluders)
        visible_[m] = next_visibility(camera_, visible_[i], ways_[m], sharpest_window(place));
}

void PathWalk::arrive_from_sky() {
    const float escaped = taken(record_.escaped, record_.escape_in_view);
    if (counts(escaped)) {
        const auto seen_by =
            record_.escape_in_view ? std::optional(kind_of_escape()) : std::nullopt;
        light_.add(sky_field(record_.escape_direction, seen_by), escaped);
        carry_from_infinity(*light_.field, record_.escape_direction, record_.count - 1,
                            light_.weight);
    }
    light_.add_glow(-record_.escape_direction, taken(record_.escape_glow, false));
}

std::optional<OwnOutline> PathWalk::scatter_at(int i) {
    if (!counts(light_.weight)) light_.clear();
    if (!(light_.weight > 0) && !counts(taken(vertex(i).direct, false)) &&
        !counts(taken(vertex(i).mirrored, false)))
        return std::nullopt;
    if (vertex(i).medium < 0) return scatter_on_surface(i);
    scatter_in_medium(i);
    return std::nullopt;
}

template <class Scatter>
void PathWalk::scatter_all(int i, const Scatter& scatter) {
    const PathVertex& v = vertex(i);
    if (light_.weight > 0)
        scatter(*light_.field, light_.emitter, v.next_event.lobes, light_.weight);
    if (const double direct = taken(v.direct, false); counts(direct)) {
        const SampledLight sampled = sampled_light(i, direct);
        scatter(sampled.field, sampled.emitter, v.direct_event.lobes, direct);
    }
    if (const double mirrored = taken(v.mirrored, false); counts(mirrored)) {
        const SampledLight sampled = mirrored_light(i, mirrored);
        scatter(sampled.field, sampled.emitter, v.mirrored_event.lobes, mirrored);
    }
}

std::optional<OwnOutline> PathWalk::scatter_on_surface(int i) {
    const ScatterPoint point(scene_, spectra_.textures, vertex(i), half_pixel(i));
    ScatterSum sum(point);
    scatter_all(i, [&](const LightField& arriving, const cov::Emitter<double>& emitter,
                       const LobeShares& lobes, double weight) {
        sum.add(arriving, emitter, lobes, weight, context_.rule, least_ * total_ / weight);
    });
    light_.field.emplace(sum.leaving());
    light_.weight = sum.weight();
    if (!context_.occluders.query) return std::nullopt;
    return own_outline(point.surface, point.motion.value_or(cov::Motion<double>{}), vertex(i).wo);
}

void PathWalk::scatter_in_medium(int i) {
    const PathVertex& v = vertex(i);
    const float g = scene_.media[size_t(v.medium)].g;
    ArrivingLight leaving;
    scatter_all(i, [&](const LightField& arriving, const cov::Emitter<double>&, const LobeShares&,
                       double weight) {
        leaving.add(cov::scatter_in_volume<double>(arriving, v.wo, g), weight);
    });
    light_ = leaving;
}

void PathWalk::emit_at(int i, std::optional<OwnOutline>& own) {
    const PathVertex& v = vertex(i);
    const float emitted = taken(v.emitted, v.in_view);
    const double way = ways_[size_t(i)];
    light_.emitter = emitter_at(v, way);
    if (!counts(emitted)) return;
    if (scene_.materials.lets_light_pass(v.material)) return shine_unlit(i, emitted, own);
    const SourceSpectrum s = spectra_.lights.source_spectrum(v.hit, v.seen_sharply);
    if (emitted > light_.weight) light_.emitter = emitter_of(s, way);
    const auto texture = emission_texture(scene_, spectra_.textures, v, s.tangent, half_pixel(i));
    light_.add(source_field(s, v.wo, v.seen_sharply, context_.smallest, texture), emitted);
    if (own || !context_.occluders.query) return;
    const DifferentialGeometry d = scene_.geometry.differential(v.hit);
    own = own_outline({d.tangent.z, d.tangent.x, d.tangent.y, {d.k11, d.k12, d.k22}},
                      {d.velocity, d.angular_velocity}, v.wo);
}

void PathWalk::shine_unlit(int i, float emitted, std::optional<OwnOutline>& own) {
    const PathVertex& v = vertex(i);
    const DifferentialGeometry d = scene_.geometry.differential(v.hit);
    const cov::Surface<double> surface{
        d.tangent.z, d.tangent.x, d.tangent.y, {d.k11, d.k12, d.k22}};
    const cov::Motion<double> motion{d.velocity, d.angular_velocity};
    light_.emitter = {d.tangent.z, ways_[size_t(i)]};
    const auto texture = emission_texture(scene_, spectra_.textures, v, d.tangent, half_pixel(i));
    light_.add(unlit_field(surface, motion, texture, v.wo), emitted);
    if (context_.occluders.query) own = own_outline(surface, motion, v.wo);
}

void PathWalk::carry_on(int i, const std::optional<OwnOutline>& own) {
    const PathVertex& v = vertex(i);
    if (light_.weight > 0 && !context_.occluders)
        light_.field->sigma = cov::travel(light_.field->sigma, double(ways_[size_t(i)]));
    else if (light_.weight > 0)
        carry(*light_.field, v.hit.position, owner(i), i - 1, light_.weight, own ? &*own : nullptr);
    light_.add_glow(v.wo, taken(v.glow, false));
}

PathCovariance PathWalk::at_sensor() {
    PathCovariance result{{}, total_};
    if (light_.field) {
        const cov::Motion<double> motion{camera_.velocity, camera_.angular_velocity};
        if (!motion.at_rest()) light_.field = cov::motion_enter(*light_.field, motion);
        result.sigma = to_sensor(*light_.field, camera_);
    }
    if (!cov::is_finite(result.sigma) || !std::isfinite(result.weight)) return {};
    return result;
}

// ---- Light that comes from elsewhere

PathWalk::SampledLight PathWalk::sampled_light(int i, double weight) const {
    const PathVertex& v = vertex(i);
    const LightSample& sample = v.light;
    const bool from_infinity = !std::isfinite(sample.distance);
    if (from_infinity && !sample.is_delta) {
        SampledLight sky{sky_field(sample.wi, {}), {}};
        carry_from_infinity(sky.field, sample.wi, i, weight);
        return sky;
    }
    const SourceSpectrum s = spectra_.lights.source_spectrum(sample, v.hit.time);
    SampledLight light{source_field(s, -sample.wi, false, context_.smallest),
                       emitter_of(s, sample.distance)};
    if (from_infinity)
        carry_from_infinity(light.field, sample.wi, i, weight);
    else if (context_.occluders)
        carry(light.field, v.hit.position + sample.wi * sample.distance, {}, i, weight);
    else
        light.field.sigma = cov::travel(light.field.sigma, double(sample.distance));
    return light;
}

PathWalk::SampledLight PathWalk::mirrored_light(int i, double weight) const {
    const int m = mirror(i);
    const PathVertex& place = vertex(m);
    const SampledLight light = sampled_light(m, weight);
    const ScatterPoint point(scene_, spectra_.textures, place, half_pixel(m));
    ScatterSum sum(point);
    sum.add(light.field, light.emitter, place.direct_event.lobes, weight, context_.rule);
    const double way = ways_[size_t(m)];
    SampledLight reflected{sum.leaving(), emitter_at(place, way)};
    if (context_.occluders)
        carry(reflected.field, place.hit.position, owner(m), i, weight);
    else
        reflected.field.sigma = cov::travel(reflected.field.sigma, way);
    return reflected;
}

RayKind PathWalk::kind_of_escape() const {
    for (int i = record_.count - 1; i >= 0; --i)
        if (vertex(i).scatters)
            return is_transmission(vertex(i).next_event.lobes.lobes[0].kind) ? RayKind::transmission
                                                                             : RayKind::glossy;
    return RayKind::camera;
}

LightField PathWalk::sky_field(Vec3 w, std::optional<RayKind> seen_by) const {
    if (spectra_.lights.has_even_sky()) return {{}, cov::frame_along<double>(-w)};
    return source_field(spectra_.lights.environment_spectrum(w, seen_by), -w, false,
                        context_.smallest);
}

// ---- The way between two vertices

void PathWalk::carry(LightField& field, Vec3 from, Owner owner_of_from, int i, double weight,
                     const OwnOutline* own) const {
    const OccluderQuery::Segment segment{from, position(i), record_.camera_ray.time, owner_of_from,
                                         owner(i)};
    field = i < 0 ? to_camera(field, segment, weight / total_, own)
                  : to_surface(field, segment, visible_[size_t(i)], weight / total_, own);
}

void PathWalk::carry_from_infinity(LightField& field, Vec3 w, int i, double weight) const {
    if (context_.occluders) carry(field, context_.entry(position(i), w), {}, i, weight);
}

LightField PathWalk::to_surface(const LightField& field, const OccluderQuery::Segment& segment,
                                const Visibility& end, double share, const OwnOutline* own) const {
    const double length = distance(segment.begin, segment.end);
    if (!context_.occluders || share < kSmallestShare || !(end.extent > 0))
        return cov::travel(field, length);
    return travel_past(context_.occluders, field, segment,
                       measure_at_surface(field.sigma, length, end), own, context_.smallest);
}

LightField PathWalk::to_camera(const LightField& field, const OccluderQuery::Segment& segment,
                               double share, const OwnOutline* own) const {
    if (!context_.occluders || share < kSmallestShare)
        return cov::travel(field, distance(segment.begin, segment.end));
    return travel_past(context_.occluders, field, segment, measure_at_camera(camera_), own,
                       context_.smallest);
}

// ---- The record

Vec3 PathWalk::position(int i) const {
    return i < 0 ? record_.camera_ray.origin : vertex(i).hit.position;
}

PathWalk::Owner PathWalk::owner(int i) const {
    if (i < 0 || vertex(i).medium >= 0) return {};
    const SurfaceHit& hit = vertex(i).hit;
    return {hit.shape, hit.instance};
}

float PathWalk::half_pixel(int i) const {
    return 0.5f * (camera_.orthographic ? 1.0f : distances_[size_t(i)]) / camera_.pixels_per_x;
}

float PathWalk::taken(float luminance, bool in_view) const {
    const bool takes = part_ == LightPart::all || (part_ == LightPart::in_view) == in_view;
    return takes ? luminance : 0.0f;
}

}  // namespace covtrace
