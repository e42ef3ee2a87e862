#include "frequency/replay.h"

#include <cmath>
#include <optional>

#include "frequency/light_source.h"
#include "frequency/scatter.h"

namespace covtrace {

namespace cov = covariance;

namespace {

/// Light that arrives at one place from one direction, and how much of it.
struct Arriving {
    std::optional<LightField> field;  ///< where the weight is above 0
    double weight = 0;
    cov::Emitter<double> emitter;

    Arriving() {}  // not one that sets the field to zero first

    void add(const LightField& other, double other_weight) {
        if (!(other_weight > 0)) return;
        if (weight > 0)
            *field = cov::merge(*field, weight, other, other_weight);
        else
            field.emplace(other);
        weight += other_weight;
    }
    void clear() {
        field.reset();
        weight = 0;
    }
    /// What an even medium emits on the way is the same for all neighbouring rays.
    void add_glow(Vec3 travel, double glow) {
        if (glow > 0) add({{}, cov::frame_along<double>(travel)}, glow);
    }
};

/// What sends light on from a vertex, as a receiver at the given distance sees it. Mirrors show an
/// emitter that is taken to face the receiver.
cov::Emitter<double> emitter_at(const PathVertex& v, double distance) {
    if (v.medium >= 0) return {{}, distance};  // a medium shines about evenly
    const LobeShares& lobes = v.scatters ? v.next_event.lobes : v.direct_event.lobes;
    const bool diffuse = lobes.count > 0 && (lobes.lobes[0].kind == LobeKind::diffuse_reflection ||
                                             lobes.lobes[0].kind == LobeKind::diffuse_transmission);
    return {diffuse ? v.hit.ns : v.wo, distance};
}

/// Light below this part of a path's luminance is carried without a look at its occluders, the
/// dearest step of the replay: the contrast of its shadow edges is below what the spectra of
/// textures count as visible.
constexpr double kSmallestShare = 0.1;

/// A contribution or lobe below this part of a path's luminance is not followed: whatever a filter
/// does to it alone changes a pixel by less than counts as a change (docs/internals/prediction.md).
constexpr double kInvisible = 0.02;
/// All together they may be as much of a path's light as one contribution may be that is carried
/// without its occluders; where they are more, every one is followed.
constexpr double kLeastFollowed = 1 - kSmallestShare;

/// `at_rest`: beside a camera that rests.
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

PathReplay::PathReplay(const RenderScene& scene, const Occluders& occluders, BrdfCovariance rule)
    : scene_(scene), occluders_(occluders), rule_(rule) {
    const Bounds3 bounds = scene.geometry.bounds();
    center_ = bounds.center();
    radius_ = std::max(bounds.radius(), 1e-6f);
    smallest_ = 1e-4 * radius_;
}

LightField PathReplay::to_surface(const LightField& field, const OccluderQuery::Segment& segment,
                                  const Visibility& end, double share,
                                  const OwnOutline* own) const {
    const double length = distance(segment.begin, segment.end);
    if (!occluders_ || share < kSmallestShare || !(end.extent > 0))
        return cov::travel(field, length);
    return travel_past(occluders_, field, segment, measure_at_surface(field.sigma, length, end),
                       own, smallest_);
}

LightField PathReplay::to_camera(const LightField& field, const OccluderQuery::Segment& segment,
                                 const SensorGeometry& camera, double share,
                                 const OwnOutline* own) const {
    if (!occluders_ || share < kSmallestShare)
        return cov::travel(field, distance(segment.begin, segment.end));
    return travel_past(occluders_, field, segment, measure_at_camera(camera), own, smallest_);
}

PathCovariance PathReplay::operator()(const PathRecord& record, LightPart part) const {
    double kept = 0;
    const PathCovariance bright = follow(record, part, kInvisible, kept);
    if (!(bright.weight > 0) || kept > kLeastFollowed * bright.weight) return bright;
    return follow(record, part, 0, kept);
}

PathCovariance PathReplay::follow(const PathRecord& record, LightPart part, double least,
                                  double& kept) const {
    const auto taken = [part](float luminance, bool in_view) {
        const bool takes = part == LightPart::all || (part == LightPart::in_view) == in_view;
        return takes ? luminance : 0.0f;
    };
    const float escaped = taken(record.escaped, record.escape_in_view);
    const SensorGeometry camera = scene_.camera.sensor(record.camera_ray);
    /// Where light from infinity, seen from p in the direction w, enters the scene's bounding
    /// sphere.
    const auto entry = [&](Vec3 p, Vec3 w) {
        const Vec3 o = p - center_;
        const float b = dot(o, w), c = length_squared(o) - sqr(radius_);
        return p + w * std::max(0.0f, -b + safe_sqrt(b * b - c));
    };

    double total = double(escaped) + taken(record.escape_glow, false);
    for (int i = 0; i < record.count; ++i) {
        const PathVertex& v = record.vertices[size_t(i)];
        total +=
            double(taken(v.emitted, v.in_view)) + taken(v.direct, false) + taken(v.glow, false);
    }
    if (!(total > 0)) return {};
    const auto counts = [least, total](double luminance) {
        return luminance > 0 && luminance >= least * total;
    };

    // Half a pixel's extent grows with the distance travelled from the camera; what can be seen of
    // a vertex shrinks with every rough surface before it.
    std::array<float, PathRecord::kCapacity> ways, distances;  // to the previous vertex, to all
    std::array<Visibility, PathRecord::kCapacity> visible;
    Vec3 previous = record.camera_ray.origin;
    float travelled = 0;
    for (size_t i = 0; i < size_t(record.count); ++i) {
        const PathVertex& v = record.vertices[i];
        const float d = distance(previous, v.hit.position);
        travelled += d;
        ways[i] = d;
        distances[i] = travelled;
        previous = v.hit.position;
        if (!occluders_) continue;
        visible[i] = i == 0 ? first_visibility(camera, d, sharpest_window(v))
                            : next_visibility(camera, visible[i - 1], d, sharpest_window(v));
    }
    const auto position = [&record](int i) {
        return i < 0 ? record.camera_ray.origin : record.vertices[size_t(i)].hit.position;
    };
    const auto owner = [&record](int i) -> OccluderQuery::Owner {
        if (i < 0 || record.vertices[size_t(i)].medium >= 0) return {};
        const SurfaceHit& hit = record.vertices[size_t(i)].hit;
        return {hit.shape, hit.instance};
    };

    /// Carries light past occluders to vertex i, to the camera where i is below 0. `own`: of the
    /// surface it has left.
    const auto carry = [&](LightField& field, Vec3 from, OccluderQuery::Owner owner_of_from, int i,
                           double weight, const OwnOutline* own = nullptr) {
        const Vec3 to = position(i);
        const OccluderQuery::Segment segment{from, to, record.camera_ray.time, owner_of_from,
                                             owner(i)};
        field = i < 0 ? to_camera(field, segment, camera, weight / total, own)
                      : to_surface(field, segment, visible[size_t(i)], weight / total, own);
    };
    /// The same from infinity, in direction w from there. Without occluders on the way nothing
    /// changes: such light has no variation in space.
    const auto carry_from_infinity = [&](LightField& field, Vec3 w, int i, double weight) {
        if (occluders_) carry(field, entry(position(i), w), {}, i, weight);
    };

    const auto sky_field = [&](Vec3 w) -> LightField {
        if (scene_.lights.has_even_sky()) return {{}, cov::frame_along<double>(-w)};
        return source_field(scene_.lights.environment_spectrum(w), -w, false, smallest_);
    };
    Arriving light;
    if (counts(escaped)) {
        light.add(sky_field(record.escape_direction), escaped);
        carry_from_infinity(*light.field, record.escape_direction, record.count - 1, light.weight);
    }
    light.add_glow(-record.escape_direction, taken(record.escape_glow, false));

    const auto own_outline = [](const cov::Surface<double>& surface,
                                const cov::Motion<double>& motion,
                                Vec3 outgoing) -> std::optional<OwnOutline> {
        const auto contour = cov::contour<double>(surface, outgoing);
        if (!contour) return std::nullopt;
        return OwnOutline{*contour, motion};
    };
    const auto half_pixel = [&](int i) {
        return 0.5f * (camera.orthographic ? 1.0f : distances[i]) / camera.pixels_per_x;
    };

    for (int i = record.count - 1; i >= 0; --i) {
        const PathVertex& v = record.vertices[size_t(i)];
        const float emitted = taken(v.emitted, v.in_view), direct = taken(v.direct, false);
        std::optional<OwnOutline> own;
        const bool has_direct = counts(direct);
        if (!counts(light.weight)) light.clear();
        if (light.weight > 0 || has_direct) {
            /// Sends on, by `scatter`, what arrives from further on and from the sampled light.
            const auto scatter_all = [&](const auto& scatter) {
                if (light.weight > 0)
                    scatter(*light.field, light.emitter, v.next_event.lobes, light.weight);
                if (!has_direct) return;
                const LightSample& sample = v.light;
                const LobeShares& lobes = v.direct_event.lobes;
                if (!std::isfinite(sample.distance) && !sample.is_delta) {
                    LightField arriving = sky_field(sample.wi);
                    carry_from_infinity(arriving, sample.wi, i, direct);
                    return scatter(arriving, {}, lobes, direct);
                }
                const SourceSpectrum s = scene_.lights.source_spectrum(sample, v.hit.time);
                LightField arriving = source_field(s, -sample.wi, false, smallest_);
                if (!occluders_ && std::isfinite(sample.distance))
                    arriving.sigma = cov::travel(arriving.sigma, sample.distance);
                else if (std::isfinite(sample.distance))
                    carry(arriving, v.hit.position + sample.wi * sample.distance, {}, i, direct);
                else
                    carry_from_infinity(arriving, sample.wi, i, direct);
                scatter(arriving, emitter_of(s, sample.distance), lobes, direct);
            };
            if (v.medium < 0) {
                const ScatterPoint point(scene_, v, half_pixel(i));
                ScatterSum sum(point);
                scatter_all([&](const LightField& arriving, const cov::Emitter<double>& emitter,
                                const LobeShares& lobes, double weight) {
                    sum.add(arriving, emitter, lobes, weight, rule_, least * total / weight);
                });
                light.field.emplace(sum.leaving());
                light.weight = sum.weight();
                if (occluders_.query)
                    own = own_outline(point.surface, point.motion.value_or(cov::Motion<double>{}),
                                      v.wo);
            } else {
                const float g = scene_.media[size_t(v.medium)].g;
                Arriving leaving;
                scatter_all([&](const LightField& arriving, const cov::Emitter<double>&,
                                const LobeShares&, double weight) {
                    leaving.add(cov::scatter_in_volume<double>(arriving, v.wo, g), weight);
                });
                light = leaving;
            }
        }
        const double way = ways[size_t(i)];
        light.emitter = emitter_at(v, way);
        if (counts(emitted)) {
            const SourceSpectrum s = scene_.lights.source_spectrum(v.hit, v.seen_sharply);
            if (emitted > light.weight) light.emitter = emitter_of(s, way);
            const auto texture = emission_texture(scene_, v, s.tangent, half_pixel(i));
            light.add(source_field(s, v.wo, v.seen_sharply, smallest_, texture), emitted);
            if (!own && occluders_.query) {
                const DifferentialGeometry d = scene_.geometry.differential(v.hit);
                own = own_outline({d.tangent.z, d.tangent.x, d.tangent.y, {d.k11, d.k12, d.k22}},
                                  {d.velocity, d.angular_velocity}, v.wo);
            }
        }
        if (light.weight > 0 && !occluders_)
            light.field->sigma = cov::travel(light.field->sigma, way);
        else if (light.weight > 0)
            carry(*light.field, v.hit.position, owner(i), i - 1, light.weight,
                  own ? &*own : nullptr);
        light.add_glow(v.wo, taken(v.glow, false));
    }

    kept = light.weight;
    PathCovariance result{{}, total};
    if (light.field) {
        const cov::Motion<double> motion{camera.velocity, camera.angular_velocity};
        if (!motion.at_rest()) light.field = cov::motion_enter(*light.field, motion);
        result.sigma = to_sensor(*light.field, camera);
    }
    if (!cov::is_finite(result.sigma) || !std::isfinite(result.weight)) return {};
    return result;
}

}  // namespace covtrace
