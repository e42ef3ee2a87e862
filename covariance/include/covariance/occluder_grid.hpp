// Occluders beside a ray: a grid of cells that a renderer fills with its triangles and spheres, and
// that is asked for the outlines near a segment. Cells only tell which shapes to look at; the place
// of an outline follows from the shapes themselves. So the size of the cells decides only how far
// from the ray outlines are found: one cell on either side.
//
//   OccluderGrid<double> grid;
//   grid.add_triangle(a, b, c);  grid.add_sphere(center, radius, velocity);  ...
//   grid.build(-shutter / 2, shutter / 2);
//   field = travel_past(grid, field, from, to);                          (travel_past.hpp)
//
// The edge between two triangles that share both corners (to the last bit) is an outline only where
// both lie on the same side of it as the light sees them; the border of an open mesh always is. A
// crease, as where two walls meet, is an outline for light that leaves one wall close to it: that
// wall's light ends there, and the other wall's begins with another brightness.
//
// The renderer beside this library has its own search (src/occluders/query.h): a hierarchy of boxes
// with cones of blind directions, for millions of edges, instances and holes of alpha textures,
// which needs its scene; and voxels (voxel_grid.h) as in Belcour 2012, "A Frequency Analysis of
// Light Transport: From Theory to Implementation", section 5.1, with another answer than outlines.
// Sharing would mean to take either of them along. Allocates while it is built: one of the headers
// for whole scenes, see renderer.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "covariance/frame.hpp"

namespace covariance {

/// An outline beside a segment.
template <std::floating_point T = double>
struct Outline {
    /// Scene units along the ray, from where the segment begins; below 0 for one a little behind.
    T ahead = 0;
    Vec3<T> direction{};  ///< unit, across the ray, towards the outline
    T distance = 0;       ///< scene units, from the ray along `direction`
    Vec3<T> velocity{};   ///< scene units per second
};

/// Shapes that may stand beside light, in cells.
template <std::floating_point T = double>
class OccluderGrid {
  public:
    /// `cells`: their number along the longest side of the scene, at most 1000. With more of them a
    /// ray looks less far to its sides, and is faster.
    ///
    /// Errors   none. Shapes that are not finite, or whose squares are not, are left out.
    explicit OccluderGrid(int cells = 24) : cells_(std::clamp(cells, 1, 1000)) {}

    /// Adds a triangle that moves with `velocity` (of its middle: turning is not followed). Call
    /// `build` after the last shape. A quad is two triangles; the corners that they share must be
    /// the same to the last bit, or the diagonal counts as an outline: compute each corner once.
    void add_triangle(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c,
                      const Vec3<T>& velocity = {}) {
        if (!(is_usable(a) && is_usable(b) && is_usable(c) && is_usable(velocity))) return;
        add_edge(a, b, c, velocity);
        add_edge(b, c, a, velocity);
        add_edge(c, a, b, velocity);
    }

    /// Adds a sphere. Segments that start or end within 1e-5 radius of its surface count as
    /// starting or ending on it: positions of hits must be that exact, without an offset along the
    /// normal, or the sphere is an occluder of its own light.
    void add_sphere(const Vec3<T>& center, T radius, const Vec3<T>& velocity = {}) {
        if (is_usable(center) && is_usable(radius) && is_usable(velocity))
            spheres_.push_back({center, velocity, radius});
    }

    /// Adds a sphere far larger than the rest of the scene, which stands for a ground or a wall:
    /// every segment looks at it, and it does not widen the cells.
    void add_huge_sphere(const Vec3<T>& center, T radius) {
        if (is_usable(center) && is_usable(radius)) huge_.push_back({center, {}, radius});
    }

    /// Sorts the shapes into cells. They stand where they were added at the time 0, and are
    /// found at times from `earliest` to `latest`, seconds.
    void build(T earliest = 0, T latest = 0) {
        find_bounds(earliest, latest);
        std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;  // cell, shape
        for (std::uint32_t shape = 0; shape < edges_.size() + spheres_.size(); ++shape)
            enter(shape, earliest, latest, entries);
        std::sort(entries.begin(), entries.end());
        entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
        first_.assign(std::size_t(n_[0]) * std::size_t(n_[1]) * std::size_t(n_[2]) + 1, 0);
        shapes_.clear();
        for (const auto& [cell, shape] : entries) {
            ++first_[cell + 1];
            shapes_.push_back(shape);
        }
        for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
        index_.clear();
    }

    /// Extent that stands for a point: 1e-4 of the scene's radius, scene units.
    [[nodiscard]] T smallest() const noexcept { return T(0.5e-4) * length(high_ - low_); }
    /// The same where light arrives at a distance behind it: no more than an angle of 2e-4, so that
    /// a mountain or a moon far away does not make near outlines blunt; from a thousandth of the
    /// scene's diameter on, since the mean over a pixel of edges as near as they come is infinite.
    [[nodiscard]] T smallest(T distance) const noexcept {
        const T diameter = length(high_ - low_);
        return std::min(smallest(), T(2e-4) * std::max(distance, T(1e-3) * diameter));
    }

    /// Place where light from infinity that arrives at `point` comes into the scene: the segment
    /// from there on has the occluders that matter. `towards`: unit, from the point to the light.
    [[nodiscard]] Vec3<T> entry(const Vec3<T>& point, const Vec3<T>& towards) const noexcept {
        T leave = std::numeric_limits<T>::infinity();
        for (int k = 0; k < 3; ++k) {
            const T w = component(towards, k);
            if (w == 0) continue;
            const T plane = component(w > 0 ? high_ : low_, k);
            leave = std::min(leave, (plane - component(point, k)) / w);
        }
        if (!(leave > 0) || !(leave < std::numeric_limits<T>::infinity())) leave = 0;
        for (const Sphere& s : huge_)  // a little behind its horizon
            leave = std::max(leave, dot(s.center - point, towards) + size_);
        return point + leave * towards;
    }

    /// Calls `visit(const Outline&)` for the outlines within a cell of the segment, some of them
    /// more than once.
    template <typename Visit>
    void for_each_outline(const Vec3<T>& from, const Vec3<T>& to, T time,
                          const Visit& visit) const {
        const T whole = length(to - from);
        if (first_.empty() || !(whole > 0) || !std::isfinite(whole)) return;
        const Vec3<T> d = (to - from) / whole;
        for (const Sphere& s : huge_) visit_sphere(s, from, d, whole, time, visit);
        std::size_t last = first_.size();
        const auto steps = static_cast<std::int64_t>(std::min(whole / size_ * 2, T(1e6))) + 1;
        for (std::int64_t k = 0; k <= steps; ++k) {
            const std::size_t cell = cell_of(from + (whole * T(k) / T(steps)) * d);
            if (cell == last || cell + 1 >= first_.size()) continue;
            last = cell;
            for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
                const std::uint32_t shape = shapes_[i];
                if (shape < edges_.size())
                    visit_edge(edges_[shape], from, d, whole, time, visit);
                else
                    visit_sphere(spheres_[shape - edges_.size()], from, d, whole, time, visit);
            }
        }
    }

  private:
    struct Edge {
        Vec3<T> a, b, velocity;
        std::array<Vec3<T>, 2> opposite;  ///< third corners of the triangles that share it
        int faces = 0;
    };
    struct Sphere {
        Vec3<T> center, velocity;
        T radius;
    };

    /// Whether squares of sums of a few such numbers are finite.
    static bool is_usable(T v) noexcept { return 4096 * v * v <= std::numeric_limits<T>::max(); }
    static bool is_usable(const Vec3<T>& v) noexcept {
        return is_usable(v.x) && is_usable(v.y) && is_usable(v.z);
    }

    static T component(const Vec3<T>& v, int k) noexcept {
        return k == 0 ? v.x : k == 1 ? v.y : v.z;
    }

    void add_edge(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& opposite,
                  const Vec3<T>& velocity) {
        std::array<T, 3> p{a.x, a.y, a.z}, q{b.x, b.y, b.z};
        if (q < p) std::swap(p, q);
        const auto [found, is_new] =
            index_.try_emplace({p, q}, static_cast<std::uint32_t>(edges_.size()));
        if (is_new) edges_.push_back({a, b, velocity, {}, 0});
        Edge& edge = edges_[found->second];
        if (edge.faces < 2) edge.opposite[std::size_t(edge.faces)] = opposite;
        ++edge.faces;
    }

    void find_bounds(T earliest, T latest) {
        const T far = std::numeric_limits<T>::max();
        low_ = {far, far, far}, high_ = {-far, -far, -far};
        const auto cover = [&](const Vec3<T>& p, T r) {
            if (!is_usable(p)) return;
            low_ = {std::min(low_.x, p.x - r), std::min(low_.y, p.y - r),
                    std::min(low_.z, p.z - r)};
            high_ = {std::max(high_.x, p.x + r), std::max(high_.y, p.y + r),
                     std::max(high_.z, p.z + r)};
        };
        for (const T t : {earliest, latest}) {
            for (const Edge& e : edges_)
                for (const Vec3<T>& p : {e.a, e.b}) cover(p + t * e.velocity, 0);
            for (const Sphere& s : spheres_) cover(s.center + t * s.velocity, s.radius);
        }
        if (!(low_.x <= high_.x)) low_ = high_ = {};
        const Vec3<T> extent = high_ - low_;
        const T longest = std::max({extent.x, extent.y, extent.z});
        const T least = std::numeric_limits<T>::min() * T(4 * cells_);
        size_ = longest > least ? longest / T(cells_) : T(1);
        corner_ = low_ - Vec3<T>{size_, size_, size_};  // one more cell around all
        for (int k = 0; k < 3; ++k)
            n_[std::size_t(k)] = static_cast<int>(component(extent, k) / size_) + 3;
    }

    /// The number of a point's cell; a point outside of all cells gets a number beyond the last.
    [[nodiscard]] std::size_t cell_of(const Vec3<T>& p) const noexcept {
        std::size_t cell = 0;
        for (int k = 2; k >= 0; --k) {
            const T at = (component(p, k) - component(corner_, k)) / size_;
            if (!(at >= 0 && at < T(n_[std::size_t(k)]))) return ~std::size_t{0} - 1;
            cell = cell * std::size_t(n_[std::size_t(k)]) + static_cast<std::size_t>(at);
        }
        return cell;
    }

    /// Enters a shape into all cells whose middle is at most 1.87 cells from its outline: the reach
    /// of one cell and half a cell's diagonal.
    void enter(std::uint32_t shape, T earliest, T latest,
               std::vector<std::pair<std::uint32_t, std::uint32_t>>& entries) const {
        const bool is_edge = shape < edges_.size();
        const Sphere ball = is_edge ? Sphere{} : spheres_[shape - edges_.size()];
        const Edge edge = is_edge ? edges_[shape] : Edge{};
        const Vec3<T> velocity = is_edge ? edge.velocity : ball.velocity;
        const T way = length(velocity) * (latest - earliest);
        const int times = way > 0 ? static_cast<int>(std::min(T(1e4), way / size_)) + 2 : 1;
        const T reach = T(1.87) * size_;
        for (int i = 0; i < times; ++i) {
            const T t = times > 1 ? earliest + (latest - earliest) * T(i) / T(times - 1) : earliest;
            const Vec3<T> a = (is_edge ? edge.a : ball.center) + t * velocity;
            const Vec3<T> b = (is_edge ? edge.b : ball.center) + t * velocity;
            if (!is_usable(a) || !is_usable(b)) continue;
            std::array<int, 3> lo{}, hi{};
            for (int k = 0; k < 3; ++k) {
                const T p = component(a, k) - component(corner_, k),
                        q = component(b, k) - component(corner_, k), more = reach + ball.radius;
                const T most = T(n_[std::size_t(k)] - 1);
                lo[std::size_t(k)] =
                    static_cast<int>(std::clamp((std::min(p, q) - more) / size_, T(0), most));
                hi[std::size_t(k)] =
                    static_cast<int>(std::clamp((std::max(p, q) + more) / size_, T(0), most));
            }
            for (int z = lo[2]; z <= hi[2]; ++z)
                for (int y = lo[1]; y <= hi[1]; ++y)
                    for (int x = lo[0]; x <= hi[0]; ++x) {
                        const Vec3<T> middle =
                            corner_ + size_ * Vec3<T>{T(x) + T(0.5), T(y) + T(0.5), T(z) + T(0.5)};
                        const Vec3<T> ab = b - a;
                        const T squared = dot(ab, ab);
                        const T along = squared > 0
                                            ? std::clamp(dot(middle - a, ab) / squared, T(0), T(1))
                                            : T(0);
                        if (std::abs(length(middle - a - along * ab) - ball.radius) > reach)
                            continue;
                        entries.emplace_back(
                            static_cast<std::uint32_t>((z * n_[1] + y) * n_[0] + x), shape);
                    }
        }
    }

    /// Whether the normals of two faces (of any length) differ by more than acos(0.9) = 26 degrees.
    static bool is_crease(const Vec3<T>& n0, const Vec3<T>& n1) noexcept {
        return dot(n0, n1) < T(0.9) * length(n0) * length(n1);
    }

    template <typename Visit>
    static void visit_edge(const Edge& edge, const Vec3<T>& from, const Vec3<T>& d, T whole, T time,
                           const Visit& visit) {
        const Vec3<T> ab = edge.b - edge.a;
        bool is_outline = true;
        if (edge.faces == 2) {
            const Vec3<T> across = cross(ab, d), to_0 = edge.opposite[0] - edge.a,
                          to_1 = edge.opposite[1] - edge.a;
            is_outline = dot(to_0, across) * dot(to_1, across) > 0;
            if (!is_outline && !is_crease(cross(ab, to_0), cross(to_1, ab))) return;
        }
        // Look along the ray: leave out the parts along it, cut the edge where the segment ends.
        const Vec3<T> a = edge.a + time * edge.velocity - from;
        const T at_a = dot(a, d), slope = dot(ab, d);
        const Vec3<T> flat_a = a - at_a * d, flat = ab - slope * d;
        const T squared = dot(flat, flat);
        T low = 0, high = 1;
        if (slope > 0) high = std::min(high, (whole - at_a) / slope);
        if (slope < 0) low = std::max(low, (whole - at_a) / slope);
        if (!(low <= high) || (slope == 0 && at_a > whole)) return;
        const T k = squared > 0 ? std::clamp(-dot(flat_a, flat) / squared, low, high) : low;
        const Vec3<T> offset = flat_a + k * flat;
        const T r = length(offset), ahead = at_a + k * slope;
        // The border of a surface that light has just left counts up to 2 r behind the start; a
        // crease counts up to 2 r beyond the start, too, and no further.
        if (!(r > 0) || !(ahead > -2 * r) || (!is_outline && ahead > 2 * r)) return;
        visit(Outline<T>{ahead, offset / r, r, edge.velocity});
    }

    template <typename Visit>
    static void visit_sphere(const Sphere& ball, const Vec3<T>& from, const Vec3<T>& d, T whole,
                             T time, const Visit& visit) {
        const Vec3<T> to_center = ball.center + time * ball.velocity - from;
        const T ahead = dot(to_center, d);
        const Vec3<T> offset = to_center - ahead * d;
        const T r = length(offset), touches = T(1e-5) * ball.radius;
        const bool starts_on_it = std::abs(length(to_center) - ball.radius) < touches;
        const bool ends_on_it = std::abs(length(to_center - whole * d) - ball.radius) < touches;
        if (!(r > 0)) return;
        if (starts_on_it) {  // its own contour, behind the start; none from inside
            if (ahead < 0)
                visit(
                    Outline<T>{ahead, -offset / r, std::max(ball.radius - r, T(0)), ball.velocity});
            return;
        }
        if (ends_on_it || !(ahead > 0 && ahead < whole) || r < ball.radius) return;
        visit(Outline<T>{ahead, offset / r, r - ball.radius, ball.velocity});
    }

    int cells_;
    std::vector<Edge> edges_;
    std::vector<Sphere> spheres_, huge_;
    /// Numbers of the edges, by their corners.
    std::map<std::array<std::array<T, 3>, 2>, std::uint32_t> index_;
    Vec3<T> low_, high_, corner_;
    T size_ = 1;
    std::array<int, 3> n_{};
    /// Numbers of the shapes, cell by cell, and for every cell where its own begin in them.
    std::vector<std::uint32_t> first_, shapes_;
};

}  // namespace covariance
