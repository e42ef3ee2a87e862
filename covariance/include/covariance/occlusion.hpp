// Occlusion: visibility is a factor, so its spectrum adds covariance at the distance of the
// occluder. An edge at the perpendicular distance r, in the transverse unit direction d, that moves
// with the transverse velocity v, adds
//
//   w w^T / (4 pi^2 beta^2 r^2),    w = (d_x, d_y, 0, 0, -d.v),    beta = 1/2
//
// That occlusion adds is stated in Belcour et al. 2013, "5D Covariance Tracing for Efficient
// Defocus and Motion Blur"; the rule for r is this library's: the filter that matches the result
// has the standard deviation beta r and stays clear of the edge. Use: travel to the occluder,
// occlude, travel on. A thick occluder is several of these, but an edge that crosses many cells of
// a grid must be added once, not once per cell.
#pragma once

#include "covariance/texture.hpp"

namespace covariance {

/// Adds an occluder whose edges point in several directions: `spread`, of trace 1, replaces d d^T.
///
/// Shapes   spread: symmetric 2x2 along X, Y, for instance B^T N B / trace(B^T N B) with the normal
///          tensor N of a voxel and B = [X Y]; vx, vy: velocity along X, Y.
/// Units    distance in scene units, above 0; velocity in scene units per second.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> occlude_spread(
    SymmetricMatrix5<T> s, const Sym2<NonDeduced<T>>& spread, NonDeduced<T> distance,
    NonDeduced<T> vx = 0, NonDeduced<T> vy = 0, NonDeduced<T> beta = edge_beta<T>) noexcept {
    const Sym2<T> q = edge_variance<T>(distance, beta) * spread;
    const T qvx = q.xx * vx + q.xy * vy, qvy = q.xy * vx + q.yy * vy;
    s.set_spatial(s.spatial() + q);
    s(0, 4) -= qvx;
    s(1, 4) -= qvy;
    s(4, 4) += vx * qvx + vy * qvy;
    return s;
}

/// Adds one edge: at `distance`, in the unit direction (dx, dy) along X, Y, moving with (vx, vy).
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> occlude(const SymmetricMatrix5<T>& s, NonDeduced<T> dx,
                                                    NonDeduced<T> dy, NonDeduced<T> distance,
                                                    NonDeduced<T> vx = 0, NonDeduced<T> vy = 0,
                                                    NonDeduced<T> beta = edge_beta<T>) noexcept {
    return occlude_spread(s, {dx * dx, dx * dy, dy * dy}, distance, vx, vy, beta);
}

/// Adds the edge nearest to the ray.
///
/// Shapes   offset: world vector from a point of the ray to the edge (its part along Z is ignored);
///          velocity: of the edge, in world space.
/// Units    scene units; distances below distance_min, which is above 0 (in a grid half a voxel),
///          count as distance_min.
/// Errors   none. An offset without direction adds the same in all directions.
template <std::floating_point T>
[[nodiscard]] LightField<T> occlude(const LightField<T>& field, const Vec3<NonDeduced<T>>& offset,
                                    NonDeduced<T> distance_min,
                                    const Vec3<NonDeduced<T>>& velocity = {},
                                    NonDeduced<T> beta = edge_beta<T>) noexcept {
    const Frame<T>& f = field.frame;
    const T ox = dot(offset, f.x), oy = dot(offset, f.y), r = std::hypot(ox, oy);
    const Sym2<T> spread =
        r > 0 ? Sym2<T>{(ox / r) * (ox / r), (ox / r) * (oy / r), (oy / r) * (oy / r)}
              : Sym2<T>::diagonal(T(0.5), T(0.5));
    return {occlude_spread(field.sigma, spread, std::max(r, distance_min), dot(velocity, f.x),
                           dot(velocity, f.y), beta),
            f};
}

/// Adds an occluder known by its normal tensor N = sum a_i n_i n_i^T, for a ray that passes so near
/// that the direction to it says nothing. Facets that face the ray contribute almost nothing.
///
/// Errors   none. A tensor without part across the ray adds the same in all directions.
template <std::floating_point T>
[[nodiscard]] LightField<T> occlude(const LightField<T>& field, const Sym3<NonDeduced<T>>& normals,
                                    NonDeduced<T> distance,
                                    const Vec3<NonDeduced<T>>& velocity = {},
                                    NonDeduced<T> beta = edge_beta<T>) noexcept {
    const Frame<T>& f = field.frame;
    const Sym2<T> across = restrict_to(normals, f.x, f.y);
    const T sum = trace(across);
    const Sym2<T> spread = sum > 0 ? (1 / sum) * across : Sym2<T>::diagonal(T(0.5), T(0.5));
    return {
        occlude_spread(field.sigma, spread, distance, dot(velocity, f.x), dot(velocity, f.y), beta),
        f};
}

/// Widest extent, as a standard deviation in scene units, of the local light field across the ray:
/// 1/(2 pi sqrt(lambda_min)) of the spatial block; infinite where nothing limits it.
///
/// Occluders farther away than a few such radii do not matter; `limit_curvature` takes one too.
template <std::floating_point T>
[[nodiscard]] T footprint_radius(const SymmetricMatrix5<T>& s) noexcept {
    const T low = eigen(s.spatial()).low;
    return low > 0 ? 1 / (2 * pi<T> * std::sqrt(low)) : std::numeric_limits<T>::infinity();
}

}  // namespace covariance
