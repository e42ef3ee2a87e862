#include "laboratory/fields.h"

#include <cmath>

namespace covtrace {

namespace {

/// The direction in which a specular event goes on; empty for total reflection where light should
/// pass. `eta`: index beyond over index before.
std::optional<Vec3> specular_direction(Vec3 d, Vec3 normal, LobeKind kind, float eta) {
    const Vec3 n = dot(normal, d) > 0 ? -normal : normal;
    const float c = -dot(d, n);
    if (kind == LobeKind::specular_reflection) return normalize(d + n * (2 * c));
    const float sin2 = (1 - c * c) / sqr(eta);
    if (sin2 >= 1) return std::nullopt;
    return normalize(d * (1 / eta) + n * (c / eta - std::sqrt(1 - sin2)));
}

struct Interface {
    uint32_t shape = 0;
    LobeKind kind{};
    float eta = 1;
};

}  // namespace

LocalField radiance_field(const RenderScene& scene, const SensorRays& rays, int max_depth,
                          uint64_t seed) {
    return [&scene, rays, max_depth, seed](const SensorOffset& offset, uint32_t index) {
        Sampler sampler(seed, int(rays.film().x), int(rays.film().y), index);
        sampler.camera();
        const PathResult path = trace_path(scene, rays(offset), sampler, max_depth, nullptr);
        return double(luminance(path.radiance));
    };
}

LocalField probe_field(const RenderScene& scene, const SensorRays& rays, const PathRecord& record,
                       const SpatialCovariance2& spot) {
    std::vector<Interface> chain;
    for (int i = 0; i + 1 < record.count; ++i) {
        const PathVertex& v = record.vertices[size_t(i)];
        const LobeShare& lobe = v.next_event.lobes.lobes[0];
        chain.push_back({v.hit.shape, lobe.kind, lobe.eta});
    }
    const SurfaceHit end = record.vertices[size_t(record.count - 1)].hit;
    return [&scene, rays, chain, end, spot](const SensorOffset& offset, uint32_t) {
        Ray ray = rays(offset);
        SurfaceHit hit;
        for (const Interface& event : chain) {
            if (!scene.geometry.intersect(ray, hit) || hit.shape != event.shape) return 0.0;
            const auto next = specular_direction(ray.direction, hit.ns, event.kind, event.eta);
            if (!next) return 0.0;
            ray.origin = Geometry::offset_origin(hit, *next);
            ray.direction = *next;
            ray.t_max = kInfinity;
        }
        if (!scene.geometry.intersect(ray, hit) || hit.shape != end.shape) return 0.0;
        const double u = hit.uv.x - end.uv.x, v = hit.uv.y - end.uv.y;
        constexpr double kTwoPiSq = 2 * double(kPi) * double(kPi);
        return std::exp(-kTwoPiSq * (spot.ss * u * u + 2 * spot.st * u * v + spot.tt * v * v));
    };
}

}  // namespace covtrace
