#include "render/unmet_emitters.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"

namespace covtrace {

namespace {

/// Expected hits after which the samples themselves tell how much they differ: the number that was
/// met is within a quarter of it, and all are missed once in e^16 times.
constexpr double kKnownAfter = 16;
/// Share of a pixel up to which an emitter is small. A larger one is met by the 16 samples that an
/// error is told after: all of them miss it once in a hundred times.
constexpr float kSmallest = 0.25f;

/// A ray's way between two vertices of a path, or out of the scene.
struct Segment {
    Vec3 origin, direction;
    float length = 0;     ///< infinite where the path leaves the scene
    float travelled = 0;  ///< distance from the camera to the origin
    float carried = 1;    ///< luminance that the mirrors before it let through
    RayKind kind = RayKind::camera;
};

/// Visits the ways from the camera to the first vertex that scatters by another than a specular
/// lobe.
template <typename Visit>
void for_each_segment_in_view(const PathRecord& path, const Visit& visit) {
    Segment s{path.camera_ray.origin, path.camera_ray.direction, kInfinity, 0, 1, RayKind::camera};
    for (int k = 0; k < path.count; ++k) {
        const PathVertex& v = path.vertices[size_t(k)];
        s.length = distance(s.origin, v.hit.position);
        visit(s);
        const LobeShares& lobes = v.next_event.lobes;
        if (!v.scatters || v.medium >= 0 || lobes.count != 1 || !is_specular(lobes.lobes[0].kind))
            return;
        s = {v.hit.position,
             v.next_event.wi,
             kInfinity,
             s.travelled + s.length,
             s.carried * luminance(lobes.lobes[0].value),
             is_transmission(lobes.lobes[0].kind) ? RayKind::transmission : RayKind::glossy};
    }
    s.length = path.last_way;
    if (path.count < PathRecord::kCapacity) visit(s);
}

struct Moments {
    float mean = 0, square = 0;
};

/// Moments of the light of `emitter` in one path, widened to the pixel that it is seen in.
Moments widened(const Segment& s, const DistantView& emitter, const Camera& camera) {
    const Vec3 centre = emitter.box.center();
    const float along = dot(centre - s.origin, s.direction);
    const float radius = emitter.box.radius();
    if (!(along > 0) || along - radius > s.length) return {};
    // Widen the emitter to a disk as large as the pixel there
    const float half = camera.half_pixel(s.travelled + along);
    const float pixel_area = 4 * half * half;
    const Vec3 beside = centre - s.origin - along * s.direction;
    if (kPi * dot(beside, beside) > pixel_area) return {};
    const float covered = emitter.intensity / emitter.radiance / pixel_area;
    if (!(covered < kSmallest)) return {};
    const float radiance = s.carried * emitter.share_towards(-s.direction) * emitter.radiance;
    return {covered * radiance, covered * radiance * radiance};
}

/// Emitters that may be small in view. Their distance along mirrors is not known, but it is at
/// least that from the camera.
std::vector<DistantView> small_emitters(const RenderScene& scene) {
    std::vector<DistantView> emitters = scene.lights.distant_views();
    const Vec3 eye = scene.camera.generate_ray({}, {}, 0).origin;
    const Bounds3 bounds = scene.geometry.bounds();
    // Distances reach once across the scene and back by a mirror; an emitter that is farther along
    // more mirrors is left out.
    const float farthest = 4 * bounds.radius() + distance(eye, bounds.center());
    const float half = scene.camera.half_pixel(farthest);
    std::erase_if(emitters, [&](const DistantView& e) {
        return !(e.radiance > 0) || e.intensity / e.radiance > kSmallest * 4 * half * half;
    });
    return emitters;
}

}  // namespace

UnmetEmitters::UnmetEmitters(const PassContext& context, PixelBounds region) {
    const std::vector<DistantView> emitters = small_emitters(context.scene);
    if (emitters.empty()) return;
    PassContext own = context;
    own.seed =
        context.seed ^ 0x756e6d6574ull;  // paths of their own, so that samples stay as they are
    own.half = 0;
    own.halves = 1;
    mean_ = square_ = Plane(region.width(), region.height());
    parallel_for(region.height(), [&](int64_t row) {
        PathRecord record;
        PathResult path;
        for (int x = region.x0; x < region.x1; ++x) {
            take_sample(own, x, region.y0 + int(row), 0, &record, path);
            Moments sum;
            for_each_segment_in_view(record, [&](const Segment& s) {
                for (const DistantView& e : emitters) {
                    if (!contains(e.visible_to, s.kind)) continue;
                    const Moments m = widened(s, e, own.scene.camera);
                    sum.mean += m.mean;
                    sum.square += m.square;
                }
            });
            mean_(x - region.x0, int(row)) = sum.mean * own.imaging_scale;
            square_(x - region.x0, int(row)) = sum.square * sqr(own.imaging_scale);
        }
    });
}

float UnmetEmitters::variance(size_t i, double count) const {
    if (empty() || !(square_[i] > 0)) return 0;
    const double hits = count * double(mean_[i]) * double(mean_[i]) / double(square_[i]);
    return hits < kKnownAfter ? square_[i] : 0.0f;
}

float UnmetEmitters::squared_error(size_t i, double count, float brightness) const {
    const float of_one = variance(i, count);
    if (!(of_one > 0)) return 0;
    // An unseen emitter is missing altogether, one met by chance counts too much: the smaller error
    // holds.
    const double square = std::min(double(sqr(mean_[i])), double(of_one) / std::max(count, 1.0));
    return float(square / (double(sqr(brightness)) + 0.01));
}

}  // namespace covtrace
