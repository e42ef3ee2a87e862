#include "frequency/replay.h"

#include <cmath>

#include "frequency/light_source.h"
#include "frequency/scatter.h"

namespace covtrace {

namespace cov = covariance;

namespace {

/// Light that arrives at one place from one direction, and how much of it.
struct Arriving {
    LightField field;
    double weight = 0;

    void add(const LightField& other, double other_weight) {
        if (!(other_weight > 0)) return;
        field = weight > 0 ? cov::merge(field, weight, other, other_weight) : other;
        weight += other_weight;
    }
};

/// Light below this part of a path's luminance is carried without a look at its occluders, the
/// dearest step of the replay: the contrast of its shadow edges is below what the spectra of
/// textures count as visible.
constexpr double kSmallestShare = 0.1;

cov::SymmetricMatrix5<double> to_sensor(const LightField& field, const SensorGeometry& g) {
    const LightField at_rest = cov::motion_enter(field, {g.velocity, g.angular_velocity});
    if (g.orthographic)
        return cov::sensor(at_rest, cov::OrthographicLens<double>{
                                        g.right, g.down, g.forward, g.focal_distance, g.lens_radius,
                                        g.pixels_per_x, g.pixels_per_y, g.shutter});
    return cov::sensor(
        at_rest, cov::ThinLens<double>{g.right, g.down, g.forward, g.focal_distance, g.lens_radius,
                                       g.pixels_per_x, g.pixels_per_y, g.shutter});
}

}  // namespace

PathReplay::PathReplay(const RenderScene& scene, const VoxelGrid* occluders)
    : scene_(scene), occluders_(occluders) {
    const Bounds3 bounds = scene.geometry.bounds();
    center_ = bounds.center();
    radius_ = std::max(bounds.radius(), 1e-6f);
    smallest_ = 1e-4 * radius_;
}

LightField PathReplay::carry(LightField field, Vec3 from, Vec3 to, double share) const {
    double at = 0;
    if (occluders_ && share >= kSmallestShare) {
        const float voxel = occluders_->voxel_size();
        VoxelMarch march(*occluders_, from, to);
        OccluderEvent e;
        while (march.next(float(std::min(cov::footprint_radius(field.sigma), 3.0 * voxel)), e)) {
            field = cov::travel(field, e.s - at);
            at = e.s;
            // So near that the direction to the centroid is chance: the surface's normals tell
            // where its edge is.
            const bool touches = length(e.offset) < 0.5f * voxel;
            const NormalTensor& n = e.normals;
            field = touches
                        ? cov::occlude(field, cov::Sym3<double>{n.xx, n.xy, n.xz, n.yy, n.yz, n.zz},
                                       0.5 * voxel, e.velocity)
                        : cov::occlude(field, e.offset, 0.5 * voxel, e.velocity);
        }
    }
    return cov::travel(field, distance(from, to) - at);
}

PathCovariance PathReplay::operator()(const PathRecord& record) const {
    const SensorGeometry camera = scene_.camera.sensor(record.camera_ray);
    /// Where light from infinity, seen from p in the direction w, enters the scene's bounding
    /// sphere.
    const auto entry = [&](Vec3 p, Vec3 w) {
        const Vec3 o = p - center_;
        const float b = dot(o, w), c = length_squared(o) - sqr(radius_);
        return p + w * std::max(0.0f, -b + safe_sqrt(b * b - c));
    };

    double total = record.escaped;
    for (int i = 0; i < record.count; ++i) {
        const PathVertex& v = record.vertices[size_t(i)];
        total += double(v.emitted) + v.direct;
    }
    if (!(total > 0)) return {};

    Arriving light;
    if (record.escaped > 0) {
        const SourceSpectrum s = scene_.lights.environment_spectrum(record.escape_direction);
        light.add(source_field(s, -record.escape_direction, record.escape_seen_sharply, smallest_),
                  record.escaped);
        const Vec3 last = record.count > 0 ? record.vertices[size_t(record.count - 1)].hit.position
                                           : record.camera_ray.origin;
        light.field =
            carry(light.field, entry(last, record.escape_direction), last, light.weight / total);
    }

    // Half a pixel's extent grows with the distance travelled from the camera.
    float distances[PathRecord::kCapacity];
    Vec3 previous = record.camera_ray.origin;
    float travelled = 0;
    for (int i = 0; i < record.count; ++i) {
        const Vec3 p = record.vertices[size_t(i)].hit.position;
        travelled += distance(previous, p);
        distances[i] = travelled;
        previous = p;
    }

    const auto half_pixel = [&](int i) {
        return 0.5f * (camera.orthographic ? 1.0f : distances[i]) / camera.pixels_per_x;
    };

    for (int i = record.count - 1; i >= 0; --i) {
        const PathVertex& v = record.vertices[size_t(i)];
        Arriving leaving;
        if (light.weight > 0 || v.direct > 0) {
            const ScatterPoint point = scatter_point(scene_, v, half_pixel(i));
            if (light.weight > 0)
                leaving.add(scatter(light.field, point, v.next_event.lobes), light.weight);
            if (v.direct > 0) {
                const SourceSpectrum s = scene_.lights.source_spectrum(v.light, v.hit.time);
                const Vec3 from = std::isfinite(v.light.distance)
                                      ? v.hit.position + v.light.wi * v.light.distance
                                      : entry(v.hit.position, v.light.wi);
                const LightField source = source_field(s, -v.light.wi, false, smallest_);
                leaving.add(scatter(carry(source, from, v.hit.position, v.direct / total), point,
                                    v.direct_event.lobes),
                            v.direct);
            }
        }
        if (v.emitted > 0) {
            const SourceSpectrum s = scene_.lights.source_spectrum(v.hit);
            const auto texture = emission_texture(scene_, v, s.tangent, half_pixel(i));
            leaving.add(source_field(s, v.wo, v.seen_sharply, smallest_, texture), v.emitted);
        }
        light = leaving;
        if (!(light.weight > 0)) continue;
        const Vec3 next =
            i > 0 ? record.vertices[size_t(i - 1)].hit.position : record.camera_ray.origin;
        light.field = carry(light.field, v.hit.position, next, light.weight / total);
    }

    if (!(light.weight > 0)) return {};
    const PathCovariance result{to_sensor(light.field, camera), light.weight};
    if (!cov::is_finite(result.sigma) || !std::isfinite(result.weight)) return {};
    return result;
}

}  // namespace covtrace
