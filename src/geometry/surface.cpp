#include "geometry/surface.h"

#include <algorithm>
#include <cmath>

#include "core/frame.h"
#include "core/parallel.h"
#include "geometry/quadric.h"

namespace covtrace {

LocalShape make_local_shape(const ShapeDescription& description,
                            const Transform& local_from_object) {
    const bool reverse = description.reverse_orientation;
    return std::visit(
        [&](const auto& geometry) -> LocalShape {
            using G = std::decay_t<decltype(geometry)>;
            if constexpr (std::is_same_v<G, std::shared_ptr<const TriangleMesh>>) {
                TriangleShape shape = make_triangle_shape(geometry, local_from_object, reverse);
                if (!description.is_seen_from_back)
                    shape.opposites = OppositeTriangles::of(*geometry);
                return shape;
            } else if constexpr (std::is_same_v<G, std::shared_ptr<const BilinearMesh>>)
                return make_patch_shape(geometry, local_from_object, reverse);
            else
                return make_quadric(geometry, local_from_object, reverse);
        },
        description.geometry);
}

SurfacePoint surface_point(const LocalShape& shape, uint32_t primitive, Vec2 barycentric,
                           Vec3d near) {
    if (const auto* triangles = std::get_if<TriangleShape>(&shape))
        return triangle_point(*triangles, primitive, barycentric);
    if (const auto* patches = std::get_if<PatchShape>(&shape))
        return patch_point(*patches, primitive, barycentric);
    return quadric_point(std::get<Quadric>(shape), near);
}

SurfaceDerivatives surface_derivatives(const LocalShape& shape, uint32_t primitive,
                                       Vec2 barycentric, Vec3d near) {
    if (const auto* triangles = std::get_if<TriangleShape>(&shape))
        return triangle_derivatives(*triangles, primitive, barycentric);
    if (const auto* patches = std::get_if<PatchShape>(&shape))
        return patch_derivatives(*patches, primitive, barycentric);
    return quadric_derivatives(std::get<Quadric>(shape), near);
}

/// Tangents where (s, t) rests in a direction at least: there it is taken to change by 1 over
/// kRestingLengths times the size of the primitive, so that a pixel's footprint in (s, t) is next
/// to nothing, as it truly is.
void solve_resting_tangents(Vec3d dpda, Vec3d dpdb, Vec2 duvda, Vec2 duvdb, Vec3d normal,
                            Vec3d& dpdu, Vec3d& dpdv) {
    // More would show in steps of bump maps, which are no smaller than the rounding of (s, t).
    constexpr double kRestingLengths = 1000;
    const Frame frame = Frame::from_z(normal.to_float());
    const Vec3d x(frame.x), y(frame.y);
    const double ax = dot(dpda, x), ay = dot(dpda, y), bx = dot(dpdb, x), by = dot(dpdb, y);
    const double area = ax * by - ay * bx;
    const double resting =
        kRestingLengths * std::sqrt(std::max(ax * ax + ay * ay, bx * bx + by * by));
    dpdu = x;
    dpdv = y;
    if (!(std::abs(area) > 0 && std::isfinite(resting))) return;
    dpdu = x * resting;
    dpdv = y * resting;

    const auto gradient = [&](double by_a, double by_b) {
        return (x * (by_a * by - by_b * ay) + y * (by_b * ax - by_a * bx)) * (1 / area);
    };
    const Vec3d s = gradient(duvda.x, duvdb.x), t = gradient(duvda.y, duvdb.y);
    const double size = std::sqrt(dot(s, s) + dot(t, t));
    if (!(size * resting > 1 && std::isfinite(size))) return;
    const Vec3d along = normalize(dot(s, s) > dot(t, t) ? s : t);
    const Vec3d across = cross(Vec3d(frame.z), along);
    const double by_s = dot(s, along) / size, by_t = dot(t, along) / size;
    dpdu = along * (by_s / size) - across * (by_t * resting);
    dpdv = along * (by_t / size) + across * (by_s * resting);
}

void solve_tangents(Vec3d dpda, Vec3d dpdb, Vec2 duvda, Vec2 duvdb, Vec3d normal, Vec3d& dpdu,
                    Vec3d& dpdv) {
    const double ua = duvda.x, va = duvda.y, ub = duvdb.x, vb = duvdb.y;
    const double determinant = ua * vb - ub * va;
    const double scale = (std::abs(ua) + std::abs(ub)) * (std::abs(va) + std::abs(vb));
    if (std::abs(determinant) > 1e-7 * scale) {
        dpdu = (dpda * vb - dpdb * va) * (1 / determinant);
        dpdv = (dpdb * ua - dpda * ub) * (1 / determinant);
        const Vec3d area = cross(dpdu, dpdv);
        const double a2 = dot(area, area);
        if (a2 > 0 && std::isfinite(static_cast<float>(a2))) return;
    }
    solve_resting_tangents(dpda, dpdb, duvda, duvdb, normal, dpdu, dpdv);
}

std::vector<Vec3> transform_points(const std::vector<Vec3>& positions, const Transform& map,
                                   size_t spare) {
    std::vector<Vec3> moved(positions.size() + spare);
    constexpr size_t kChunk = 16384;
    const auto body = [&](int64_t chunk) {
        const size_t begin = static_cast<size_t>(chunk) * kChunk;
        const size_t end = std::min(positions.size(), begin + kChunk);
        for (size_t i = begin; i < end; ++i) moved[i] = map.point(positions[i]);
    };
    if (map.is_identity())
        std::copy(positions.begin(), positions.end(), moved.begin());
    else if (positions.size() <= kChunk)
        body(0);
    else
        parallel_for(static_cast<int64_t>((positions.size() + kChunk - 1) / kChunk), body);
    return moved;
}

}  // namespace covtrace
