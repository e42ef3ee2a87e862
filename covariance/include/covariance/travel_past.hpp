// Travel past occluders beside the way: among the outlines that an OccluderGrid finds near a
// segment the few that matter where the light arrives, each added at its distance (occlusion.hpp).
//
// An outline matters by the width of the shadow edge that it makes at the end of the segment. With
// the light's covariance M over (x, u) there (both axes added) and an edge q w w^T, w = (1, -z), q
// = 1/(4 pi^2 beta^2 r^2), the Schur complement over x becomes (det M + q h) / (Muu + q z^2), h =
// w^T adj(M) w. The edge's part of it, q h / (Muu + q z^2), is 1/(4 pi^2 width^2):
//
//   width^2 = (z^2/(4 pi^2 Muu) + beta^2 r^2) / (1 + 2 z Mxu/Muu + z^2 Mxx/Muu)
//
// with r the outline's distance from the ray and z its distance from the end. At a camera the width
// is a slope, and the circle of confusion of the lens takes the place of the first term.
#pragma once

#include <array>

#include "covariance/lens.hpp"
#include "covariance/occluder_grid.hpp"
#include "covariance/occlusion.hpp"
#include "covariance/travel.hpp"

namespace covariance {

/// Squared width of the edge that an outline makes where the light arrives: ((a0 + a1 z)^2 + beta^2
/// r^2) / (h0 + h1 z + h2 z^2), z the distance from the end of the segment.
template <std::floating_point T = double>
struct EdgeMeasure {
    T a0 = 0, a1 = 0, h0 = 1, h1 = 0, h2 = 0;

    [[nodiscard]] constexpr T width_squared(T z, T r) const noexcept {
        const T a = a0 + a1 * z, h = h0 + z * (h1 + z * h2);
        return (a * a + edge_beta<T> * edge_beta<T> * r * r) / std::max(h, T(1e-6));
    }
};

/// Angular window of a diffuse receiver that light may meet at the end of a segment, 1/rad^2.
template <std::floating_point T>
inline constexpr T diffuse_receiver = 1 / (pi<T> * pi<T>);
template <std::floating_point T>
inline constexpr T mirror_receiver = T(1e6);  ///< window of mirrors and clear glass, 1/rad^2

/// The measure at a surface at the end of a segment of the length `whole`, for light that starts as
/// `leaving`. `window`: angular covariance per axis of the surface's sharpest lobe, in outgoing
/// slopes: `diffuse_receiver<T>`, `mirror_receiver<T>`, or that of a glossy lobe.
template <std::floating_point T>
[[nodiscard]] EdgeMeasure<T> edge_measure_at_surface(const SymmetricMatrix5<T>& leaving,
                                                     NonDeduced<T> whole,
                                                     NonDeduced<T> window) noexcept {
    const auto s = travel(leaving, whole);  // as it arrives with nothing beside its way
    const T xx = s(0, 0) + s(1, 1), xu = s(0, 2) + s(1, 3), uu = s(2, 2) + s(3, 3) + 2 * window;
    return {0, 1 / (2 * pi<T> * std::sqrt(uu)), 1, 2 * xu / uu, xx / uu};
}

/// The measure at a camera: widths are slopes, (R/2)(1/z - 1/focus distance) for an edge on the
/// ray.
template <std::floating_point T>
[[nodiscard]] EdgeMeasure<T> edge_measure_at_camera(const ThinLens<T>& camera) noexcept {
    return {camera.lens_radius / 2, -camera.lens_radius / (2 * camera.focus_distance), 0, 0, 1};
}

namespace detail {

/// Keeps the narrowest outline of each quarter of the directions.
template <std::floating_point T>
class NarrowestOutlines {
  public:
    NarrowestOutlines(const Frame<T>& frame, const EdgeMeasure<T>& measure, T whole) noexcept
        : frame_(frame), measure_(measure), whole_(whole) {}

    void add(const Outline<T>& o) noexcept {
        const T width = measure_.width_squared(whole_ - o.ahead, o.distance);
        const std::size_t quarter =
            (dot(o.direction, frame_.x) < 0 ? 1U : 0U) + (dot(o.direction, frame_.y) < 0 ? 2U : 0U);
        if (width < width_[quarter]) {
            width_[quarter] = width;
            outline_[quarter] = o;
        }
    }

    /// Writes the outlines that matter, from the beginning of the segment on: none of more than
    /// four times the narrowest one's width, none that repeats the direction of a narrower one.
    /// Returns how many.
    std::size_t sorted(std::array<Outline<T>, 4>& result) noexcept {
        std::array<std::size_t, 4> order{0, 1, 2, 3};
        std::sort(order.begin(), order.end(),
                  [&](std::size_t i, std::size_t j) { return width_[i] < width_[j]; });
        std::size_t n = 0;
        for (const std::size_t i : order) {
            bool matters = width_[i] < std::numeric_limits<T>::infinity() &&
                           width_[i] <= 16 * width_[order[0]];
            for (std::size_t j = 0; j < n; ++j)
                matters =
                    matters && std::abs(dot(result[j].direction, outline_[i].direction)) < T(0.8);
            if (matters) result[n++] = outline_[i];
        }
        std::sort(result.begin(), result.begin() + std::ptrdiff_t(n),
                  [](const Outline<T>& a, const Outline<T>& b) { return a.ahead < b.ahead; });
        return n;
    }

  private:
    static constexpr T none = std::numeric_limits<T>::infinity();
    Frame<T> frame_;
    EdgeMeasure<T> measure_;
    T whole_;
    std::array<Outline<T>, 4> outline_{};
    std::array<T, 4> width_{none, none, none, none};
};

}  // namespace detail

/// Carries light from `from` to `to`, past the outlines that matter by `measure`.
///
/// Pre      field.frame.z is the direction from `from` to `to`. Both are finite: light from
///          infinity starts at `grid.entry(to, towards the light)`. The way itself is free of
///          occluders.
/// Units    scene units; time in seconds, 0 where the shapes stand as they were added.
template <std::floating_point T>
[[nodiscard]] LightField<T> travel_past(const OccluderGrid<T>& grid, const LightField<T>& field,
                                        const Vec3<NonDeduced<T>>& from,
                                        const Vec3<NonDeduced<T>>& to,
                                        const EdgeMeasure<NonDeduced<T>>& measure,
                                        NonDeduced<T> time = 0) {
    const T whole = length(Vec3<T>(to) - Vec3<T>(from));
    detail::NarrowestOutlines<T> narrowest(field.frame, measure, whole);
    grid.for_each_outline(from, to, time, [&](const Outline<T>& o) { narrowest.add(o); });
    std::array<Outline<T>, 4> outlines;
    const std::size_t n = narrowest.sorted(outlines);
    LightField<T> past = field;
    T at = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const Outline<T>& o = outlines[i];
        past = travel(past, o.ahead - at);
        at = o.ahead;
        const T smallest = grid.smallest(whole - at);
        past = occlude(past, std::max(o.distance, smallest) * o.direction, smallest, o.velocity);
    }
    return travel(past, whole - at);
}

/// Carries light to a surface, past outlines; `window` as in `edge_measure_at_surface`.
template <std::floating_point T>
[[nodiscard]] LightField<T> travel_past(const OccluderGrid<T>& grid, const LightField<T>& field,
                                        const Vec3<NonDeduced<T>>& from,
                                        const Vec3<NonDeduced<T>>& to,
                                        NonDeduced<T> window = diffuse_receiver<T>,
                                        NonDeduced<T> time = 0) {
    const T whole = length(Vec3<T>(to) - Vec3<T>(from));
    return travel_past(grid, field, from, to, edge_measure_at_surface(field.sigma, whole, window),
                       time);
}

/// Carries light to the camera, past outlines.
template <std::floating_point T>
[[nodiscard]] LightField<T> travel_past(const OccluderGrid<T>& grid, const LightField<T>& field,
                                        const Vec3<NonDeduced<T>>& from,
                                        const Vec3<NonDeduced<T>>& to,
                                        const ThinLens<NonDeduced<T>>& camera,
                                        NonDeduced<T> time = 0) {
    return travel_past(grid, field, from, to, edge_measure_at_camera<T>(camera), time);
}

/// Carries light from infinity (a sky, a sun) to a surface: it begins to meet occluders where it
/// comes into the scene. Without occluders it would arrive as it left.
template <std::floating_point T>
[[nodiscard]] LightField<T> arrive_from_infinity(const OccluderGrid<T>& grid,
                                                 const LightField<T>& field,
                                                 const Vec3<NonDeduced<T>>& to,
                                                 NonDeduced<T> window = diffuse_receiver<T>,
                                                 NonDeduced<T> time = 0) {
    return travel_past(grid, field, grid.entry(to, -field.frame.z), to, window, time);
}

/// Carries light from infinity to a camera that sees it without a surface between.
template <std::floating_point T>
[[nodiscard]] LightField<T> arrive_from_infinity(const OccluderGrid<T>& grid,
                                                 const LightField<T>& field,
                                                 const Vec3<NonDeduced<T>>& to,
                                                 const ThinLens<NonDeduced<T>>& camera,
                                                 NonDeduced<T> time = 0) {
    return travel_past(grid, field, grid.entry(to, -field.frame.z), to,
                       edge_measure_at_camera<T>(camera), time);
}

}  // namespace covariance
