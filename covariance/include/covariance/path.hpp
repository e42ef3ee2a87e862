// A path as a tracer finds it, vertex by vertex from the camera on, and the walk back along it: the
// covariance of the light that it brings to the sensor. A tracer fills a `Path` while it traces;
// `covariance_of` applies the operators (README.md, "Following one path") in their order.
//
//   path.begin(point_on_lens, time);
//   path.add_lamp(lamp, point, radiance);  // a lamp seen from here: hit, or sampled
//   path.add_vertex({position, surface, to_camera, Lobe<double>::diffuse()});
//   path.add_lamp(lamp, point, radiance);  // a lamp that lights the last vertex: hit, or sampled
//   path.add_sky(direction, radiance);     // the sky that the last ray escaped to
//
// For what this has no name for (normal maps, sheets, media, the exact lobe of a BRDF of your own)
// apply the operators yourself. Allocates: one of the headers for whole images, see renderer.hpp.
#pragma once

#include <algorithm>
#include <vector>

#include "covariance/average.hpp"
#include "covariance/brdf.hpp"
#include "covariance/covariance_image.hpp"
#include "covariance/diffuse.hpp"
#include "covariance/lens.hpp"
#include "covariance/motion.hpp"
#include "covariance/refraction.hpp"
#include "covariance/source.hpp"
#include "covariance/travel_past.hpp"

namespace covariance {

/// A surface with this normal, tangents anywhere across it, and the curvature of a sphere: 1/radius
/// where the normal leaves the ball, -1/radius where it points inwards, 0 for flat surfaces.
template <std::floating_point T = double>
[[nodiscard]] Surface<T> surface_with_normal(const Vec3<NonDeduced<T>>& n,
                                             NonDeduced<T> curvature = 0) noexcept {
    const Frame<T> frame = frame_along<T>(n);
    return {n, frame.x, frame.y, Sym2<T>::diagonal(curvature, curvature)};
}

/// How a vertex sent on the light of a path: the lobe that the path took there.
template <std::floating_point T = double>
class Lobe {
  public:
    [[nodiscard]] static Lobe diffuse() noexcept { return {Kind::diffuse, {}}; }
    [[nodiscard]] static Lobe mirror() noexcept { return {Kind::mirror, {}}; }
    /// Metal of small path tracers: the mirror direction plus a vector from a ball of this radius.
    [[nodiscard]] static Lobe fuzzy(T fuzz) noexcept {
        return fuzz > 0 ? around_mirror(fuzz_cov<T>(fuzz)) : mirror();
    }
    /// A lobe around the mirror direction, of a covariance in 1/rad^2, for instance `phong_cov(e)`.
    [[nodiscard]] static Lobe around_mirror(const Sym2<T>& c) noexcept {
        return {Kind::around_mirror, c};
    }
    /// Reflection by microfacets: `micro_ggx(ax, ay)`, `micro_beckmann`, along the surface's
    /// tangents.
    [[nodiscard]] static Lobe glossy(const Sym2<T>& micro) noexcept {
        return {Kind::glossy, micro};
    }
    /// Clear glass: the refractive indices on the side of the camera and on that of the light.
    [[nodiscard]] static Lobe refracting(T towards_camera, T towards_light) noexcept {
        return {Kind::refracting, {}, towards_camera, towards_light};
    }
    /// Rough glass.
    [[nodiscard]] static Lobe rough_refracting(T towards_camera, T towards_light,
                                               const Sym2<T>& micro) noexcept {
        return {Kind::rough_refracting, micro, towards_camera, towards_light};
    }

    [[nodiscard]] bool is_diffuse() const noexcept { return kind_ == Kind::diffuse; }
    [[nodiscard]] bool is_mirror() const noexcept { return kind_ == Kind::mirror; }

    /// Covariance of the lobe per axis in outgoing slopes, 1/rad^2, for the search for occluders.
    [[nodiscard]] T window() const noexcept {
        const T sharpest = std::max(lobe_.xx, lobe_.yy);
        switch (kind_) {
            case Kind::diffuse:
                return diffuse_receiver<T>;
            case Kind::around_mirror:
                return std::min(sharpest, mirror_receiver<T>);
            case Kind::glossy:
                return std::min(sharpest / 4, mirror_receiver<T>);
            case Kind::rough_refracting: {
                const T bend = camera_side_ / (camera_side_ - light_side_);
                return std::min(bend * bend * sharpest, mirror_receiver<T>);
            }
            default:
                return mirror_receiver<T>;
        }
    }

    /// Sends arriving light on towards the camera, between `surface_enter` and `surface_exit`.
    [[nodiscard]] LightField<T> scatter(const LightField<T>& field, const Surface<T>& surface,
                                        const Vec3<T>& to_camera,
                                        const Emitter<T>& emitter) const noexcept {
        switch (kind_) {
            case Kind::diffuse:
                return reflect_diffuse(field, surface, to_camera, emitter);
            case Kind::around_mirror:
                return reflect_lobe(field, surface, to_camera, lobe_);
            case Kind::glossy:
                return reflect_glossy(field, surface, to_camera, lobe_);
            case Kind::refracting:
                return refract(field, surface, to_camera, light_side_, camera_side_);
            case Kind::rough_refracting:
                return refract_glossy(field, surface, to_camera, light_side_, camera_side_, lobe_);
            default:
                return reflect_specular(field, surface, to_camera);
        }
    }

  private:
    enum class Kind { diffuse, mirror, around_mirror, glossy, refracting, rough_refracting };
    Lobe(Kind kind, const Sym2<T>& lobe, T camera_side = 1, T light_side = 1) noexcept
        : kind_(kind), lobe_(lobe), camera_side_(camera_side), light_side_(light_side) {}

    Kind kind_;
    Sym2<T> lobe_;
    T camera_side_, light_side_;  ///< refractive indices
};

/// A point where a path was reflected or refracted.
template <std::floating_point T = double>
struct PathVertex {
    Vec3<T> position;    ///< on spheres without the offset that avoids self-intersection
    Surface<T> surface;  ///< of the side that is seen, or the other: see `surface_with_normal`
    Vec3<T> to_camera;   ///< unit, against the traced ray
    Lobe<T> lobe = Lobe<T>::diffuse();
    Sym2<T> texture{};   ///< spectrum of the texture in the surface's tangents, 1/(scene unit)^2
    Motion<T> motion{};  ///< of the surface
};

/// A lamp: a part of a plane, or a ball. Its outline is in the occluder grid.
template <std::floating_point T = double>
struct Lamp {
    Vec3<T> normal{};    ///< unit, on either side; zero for a ball, which shines evenly
    Vec3<T> t1{}, t2{};  ///< tangents along which the moments are; none for a ball
    Sym2<T> moments{};   ///< second moments of the shape, of the disc that is seen for a ball
    Motion<T> motion{};
    [[nodiscard]] bool is_ball() const noexcept { return normal == Vec3<T>{}; }
};

/// A lamp with the sides a and b: a rectangle, or another parallelogram.
template <std::floating_point T = double>
[[nodiscard]] Lamp<T> quad_lamp(const Vec3<NonDeduced<T>>& a,
                                const Vec3<NonDeduced<T>>& b) noexcept {
    const Vec3<T> n = normalize(cross(Vec3<T>(a), Vec3<T>(b))), t1 = normalize(Vec3<T>(a));
    const Vec3<T> t2 = cross(n, t1);
    const T along = dot(Vec3<T>(b), t1), across = dot(Vec3<T>(b), t2);
    const T first = dot(Vec3<T>(a), t1);
    const Sym2<T> sum{first * first + along * along, along * across, across * across};
    return {n, t1, t2, (T(1) / 12) * sum, {}};
}

/// A lamp with the corners a, b, c.
template <std::floating_point T = double>
[[nodiscard]] Lamp<T> triangle_lamp(const Vec3<NonDeduced<T>>& a, const Vec3<NonDeduced<T>>& b,
                                    const Vec3<NonDeduced<T>>& c) noexcept {
    const Vec3<T> side = b - a;
    const Vec3<T> n = normalize(cross(side, Vec3<T>(c - a))), t1 = normalize(side);
    const Vec3<T> t2 = cross(n, t1);
    return {n, t1, t2, triangle_moments<T>(a, b, c, t1, t2), {}};
}

/// A lamp that is a ball.
template <std::floating_point T = double>
[[nodiscard]] Lamp<T> ball_lamp(NonDeduced<T> radius) noexcept {
    return {{}, {}, {}, sphere_moments<T>(radius), {}};
}

/// The light that a path finds at one place: a lamp or the sky.
template <std::floating_point T = double>
struct PathEnd {
    std::size_t after;  ///< the number of vertices between it and the camera
    Vec3<T> color;      ///< radiance at the pixel
    bool is_sky;
    Vec3<T> point;  ///< on the lamp; for the sky the unit direction towards it
    Lamp<T> lamp;
    [[nodiscard]] T weight() const noexcept { return (color.x + color.y + color.z) / 3; }
};

/// The two parts of the light, which are filtered apart.
enum class Part {
    in_view,   ///< of lamps and sky, directly or by mirrors, glass and metal alone
    scattered  ///< all that a diffuse surface has sent on
};

/// A path with all the light that it found. Keep one and `begin` it anew: its memory is kept.
template <std::floating_point T = double>
class Path {
  public:
    /// Forgets the last path. `time`: relative to the middle of the shutter, seconds.
    void begin(const Vec3<T>& point_on_lens, T time = 0) {
        vertices_.clear();
        ends_.clear();
        origin_ = point_on_lens;
        time_ = time;
    }

    /// Adds the point where the ray was scattered.
    void add_vertex(const PathVertex<T>& vertex) { vertices_.push_back(vertex); }
    /// The last vertex: a tracer that chooses the lobe later sets it here.
    [[nodiscard]] PathVertex<T>& last_vertex() noexcept { return vertices_.back(); }

    /// Adds the light of a lamp that the last vertex (the camera before the first one) receives
    /// from `point`, whether the ray hit it by chance or it was sampled: the radiance (red, green,
    /// blue) that it adds to the pixel by way of all vertices so far. The lobe of the last vertex
    /// is the one that the light takes.
    void add_lamp(const Lamp<T>& lamp, const Vec3<T>& point, const Vec3<T>& radiance) {
        ends_.push_back({vertices_.size(), radiance, false, point, lamp});
    }
    /// Adds the light of the sky that the last vertex receives from a direction, as traced.
    void add_sky(const Vec3<T>& direction, const Vec3<T>& radiance) {
        ends_.push_back({vertices_.size(), radiance, true, direction, {}});
    }

    [[nodiscard]] const std::vector<PathVertex<T>>& vertices() const noexcept { return vertices_; }
    [[nodiscard]] const std::vector<PathEnd<T>>& ends() const noexcept { return ends_; }
    [[nodiscard]] const Vec3<T>& origin() const noexcept { return origin_; }
    [[nodiscard]] T time() const noexcept { return time_; }

    [[nodiscard]] Part part_of(const PathEnd<T>& end) const noexcept {
        for (std::size_t i = 0; i < end.after; ++i)
            if (vertices_[i].lobe.is_diffuse()) return Part::scattered;
        return Part::in_view;
    }
    /// The colour of one part of the light.
    [[nodiscard]] Vec3<T> color(Part part) const noexcept {
        Vec3<T> sum;
        for (const PathEnd<T>& end : ends_)
            if (part_of(end) == part) sum += end.color;
        return sum;
    }
    /// Whether the path met nothing at all.
    [[nodiscard]] bool is_empty() const noexcept { return vertices_.empty() && ends_.empty(); }

  private:
    Vec3<T> origin_;
    T time_ = 0;
    std::vector<PathVertex<T>> vertices_;
    std::vector<PathEnd<T>> ends_;
};

namespace detail {

/// Walks one part of a path's light back to the camera.
template <std::floating_point T>
class WalkBack {
  public:
    WalkBack(const Path<T>& path, const OccluderGrid<T>& grid, const ThinLens<T>& camera) noexcept
        : path_(path), grid_(grid), camera_(camera) {}

    /// Mean covariance at the sensor, and the radiance that it weighs.
    std::pair<SymmetricMatrix5<T>, T> run(Part part, std::size_t most_vertices) {
        std::size_t i = 0;
        const auto is_followed = [&](const PathEnd<T>& end) {
            return end.weight() > 0 && end.after <= most_vertices && path_.part_of(end) == part;
        };
        for (const PathEnd<T>& end : path_.ends())
            if (is_followed(end)) i = std::max(i, end.after);
        Light carried;
        for (;; --i) {
            Light leaving;
            if (carried.weight > 0) leave(carried, i, leaving);
            for (const PathEnd<T>& end : path_.ends())
                if (end.after == i && is_followed(end)) leave(arrival(end), i, leaving);
            if (i == 0) return {sum_.mean(), sum_.weight()};
            carried = carry(leaving, i);
        }
    }

  private:
    /// Light at a place, and where it was sent out if that is one lamp, seen in flat mirrors alone.
    struct Light {
        LightField<T> field;
        T weight = 0;
        Emitter<T> emitter;
    };

    /// Carries light to vertex i, counted from 1, or to the camera.
    LightField<T> carried_to(std::size_t i, const LightField<T>& field, const Vec3<T>& from) const {
        if (i == 0) return travel_past(grid_, field, from, path_.origin(), camera_, path_.time());
        const PathVertex<T>& v = path_.vertices()[i - 1];
        return travel_past(grid_, field, from, v.position, v.lobe.window(), path_.time());
    }

    Light arrival(const PathEnd<T>& end) const {
        const std::size_t i = end.after;
        const Vec3<T> to = i == 0 ? path_.origin() : path_.vertices()[i - 1].position;
        if (end.is_sky) {
            const LightField<T> sky = distant_source(frame_along<T>(-end.point), {});
            return {carried_to(i, sky, grid_.entry(to, end.point)), end.weight(), {}};
        }
        const T distance = length(to - end.point);
        const Vec3<T> way = (to - end.point) / distance;
        const Lamp<T>& lamp = end.lamp;
        const Surface<T> surface = lamp.is_ball() ? surface_with_normal<T>(way)
                                                  : Surface<T>{lamp.normal, lamp.t1, lamp.t2, {}};
        const LightField<T> field = motion_exit(
            surface_exit(area_source(lamp.moments, frame_along<T>(way)), surface), lamp.motion);
        return {carried_to(i, field, end.point), end.weight(), {lamp.normal, distance}};
    }

    /// Sends what arrives at place i on, and adds it to what leaves there.
    void leave(const Light& arriving, std::size_t i, Light& leaving) {
        if (i == 0) {
            sum_.add(sensor(arriving.field, camera_), arriving.weight);
            return;
        }
        const PathVertex<T>& v = path_.vertices()[i - 1];
        LightField<T> field = surface_enter(motion_enter(arriving.field, v.motion), v.surface);
        field = v.lobe.scatter(field, v.surface, v.to_camera, arriving.emitter);
        field = motion_exit(surface_exit(add_texture(field, v.texture), v.surface), v.motion);
        if (leaving.weight > 0) {
            leaving = {merge(leaving.field, leaving.weight, field, arriving.weight),
                       leaving.weight + arriving.weight,
                       {}};
            return;
        }
        leaving = {field, arriving.weight, {}};
        const Sym2<T>& curvature = v.surface.curvature;
        const bool is_flat = curvature.xx == 0 && curvature.xy == 0 && curvature.yy == 0;
        if (!v.lobe.is_mirror() || !is_flat) return;
        const Vec3<T>& m = arriving.emitter.normal;
        leaving.emitter = {m - 2 * dot(m, v.surface.n) * v.surface.n, arriving.emitter.distance};
    }

    /// Carries what leaves vertex i to the place before it.
    Light carry(const Light& leaving, std::size_t i) const {
        if (!(leaving.weight > 0)) return {};
        const Vec3<T>& from = path_.vertices()[i - 1].position;
        const Vec3<T>& to = i == 1 ? path_.origin() : path_.vertices()[i - 2].position;
        Emitter<T> emitter = leaving.emitter;
        emitter.distance += length(to - from);
        return {carried_to(i - 1, leaving.field, from), leaving.weight, emitter};
    }

    const Path<T>& path_;
    const OccluderGrid<T>& grid_;
    const ThinLens<T>& camera_;
    Accumulator<T> sum_;
};

}  // namespace detail

/// The covariance at the sensor of one part of a path's light, and the radiance that weighs it (0
/// where the path has none of that part).
///
/// Several lights that meet at a vertex are merged by their radiance behind it. Light from behind
/// more than `most_vertices` vertices is left out: deep vertices change little, and cost most.
template <std::floating_point T>
[[nodiscard]] std::pair<SymmetricMatrix5<T>, T> covariance_of(
    const Path<T>& path, Part part, const OccluderGrid<T>& grid,
    const ThinLens<NonDeduced<T>>& camera, std::size_t most_vertices = ~std::size_t{0}) {
    return detail::WalkBack<T>(path, grid, camera).run(part, most_vertices);
}

}  // namespace covariance
