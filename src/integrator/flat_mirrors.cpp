#include "integrator/flat_mirrors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <span>
#include <tuple>

#include "core/frame.h"
#include "scene/mirror.h"
#include "scene/pane.h"

namespace covtrace {

namespace {

/// Largest sine between a mirror's normal and that of a part of it, and largest distance of a
/// corner from its plane over the mirror's own size: images of lamps stay in place to far less than
/// their size, however large the scene around them is.
constexpr float kMostTilt = 1e-5f, kMostDistance = 1e-5f;
/// Steps of normals and of distances over the extent of all parts by which parts are sorted.
constexpr float kSortStep = 1e-3f;
/// Least area of a mirror over that of the largest, both times brightness.
constexpr float kLeastArea = 0.02f;
/// Most parts that are looked at, the largest ones: a round body of facets has none worth more.
constexpr size_t kMostParts = 4096;
/// Brightness that panes are taken to reflect, beside metal's 1.
constexpr float kPaneBrightness = 0.08f;

/// Most triangles by which it is told, without a ray, whether a ray meets a mirror.
constexpr size_t kMostTriangles = 32;

/// A flat triangle or convex patch of a mirror, with its corners in their order around it.
struct Part {
    uint32_t shape = 0, primitive = 0;
    float brightness = 0;
    uint32_t corner_count = 0;
    std::array<Vec3, 4> all_corners;
    Vec3 normal = {};  ///< with the side chosen by its largest coordinate
    float area = 0;

    std::span<const Vec3> corners() const { return {all_corners.data(), corner_count}; }
};

/// The one of a normal and its opposite whose largest coordinate is above 0.
Vec3 one_of_two(Vec3 n) {
    const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    const float largest = x >= y && x >= z ? n.x : y >= z ? n.y : n.z;
    return largest < 0 ? -n : n;
}

float size_of(const Part& part) {
    const auto& p = part.all_corners;
    return length(p[1] - p[0]) + length(p[2] - p[0]);
}

/// Whether a part lies in the plane of another one, the largest of a mirror.
bool lies_in_plane_of(const Part& first, const Part& part) {
    if (!(length(cross(part.normal, first.normal)) < kMostTilt)) return false;
    return std::all_of(part.corners().begin(), part.corners().end(), [&](Vec3 corner) {
        const Vec3 way = corner - first.corners()[0];
        return std::abs(dot(way, first.normal)) <= kMostDistance * (size_of(first) + length(way));
    });
}

class PartFinder {
  public:
    PartFinder(const SceneDescription& scene, const Geometry& geometry)
        : scene_(scene), geometry_(geometry) {}

    std::vector<Part> find() {
        for (uint32_t i = 0; i < geometry_.shapes().size(); ++i) {
            const PlacedShape& placed = geometry_.shapes()[i];
            const ShapeDescription& shape = placed.description;
            if (placed.is_instanced || placed.lets_light_pass ||
                shape.object_to_world.is_animated() || !is_mirror(scene_, shape))
                continue;
            const float brightness = is_pane(scene_, shape) ? kPaneBrightness : 1.0f;
            if (const auto* mesh =
                    std::get_if<std::shared_ptr<const TriangleMesh>>(&shape.geometry))
                add_triangles(i, shape, **mesh, brightness);
            else if (const auto* patches =
                         std::get_if<std::shared_ptr<const BilinearMesh>>(&shape.geometry))
                add_patches(i, shape, **patches, brightness);
        }
        return std::move(parts_);
    }

  private:
    void add_triangles(uint32_t shape, const ShapeDescription& d, const TriangleMesh& mesh,
                       float brightness) {
        for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            if (turns(mesh.normals, mesh.triangles[t])) continue;
            const WorldTriangle w = geometry_.world_triangle(shape, t, 0);
            add({shape, t, brightness, 3, {w.p0, w.p1, w.p2}}, d, mesh.normals, mesh.triangles[t]);
        }
    }
    void add_patches(uint32_t shape, const ShapeDescription& d, const BilinearMesh& mesh,
                     float brightness) {
        for (uint32_t t = 0; t < mesh.patches.size(); ++t) {
            if (turns(mesh.normals, mesh.patches[t])) continue;
            const WorldTriangle a = geometry_.world_triangle(shape, 2 * t, 0);
            const WorldTriangle b = geometry_.world_triangle(shape, 2 * t + 1, 0);
            add({shape, t, brightness, 4, {a.p0, a.p1, b.p0, a.p2}}, d, mesh.normals,
                mesh.patches[t]);
        }
    }

    /// Whether the normals of two corners differ, which tells most parts of what is round.
    template <size_t n>
    static bool turns(const std::vector<Vec3>& normals, const std::array<uint32_t, n>& corners) {
        if (normals.empty()) return false;
        constexpr float kLeastTurn = 1e-3f;  // far from the limit, as a transform may lessen it
        const Vec3 a = normals[corners[0]], b = normals[corners[1]];
        return length_squared(cross(a, b)) >
               sqr(kLeastTurn) * length_squared(a) * length_squared(b);
    }

    /// Adds a part unless it is bent, by its corners or by its normals, or not convex.
    template <size_t n>
    void add(Part part, const ShapeDescription& shape, const std::vector<Vec3>& normals,
             const std::array<uint32_t, n>& corners) {
        const std::array<Vec3, 4>& p = part.all_corners;
        Vec3 sum = cross(p[1] - p[0], p[2] - p[0]);
        if (n == 4) sum += cross(p[2] - p[0], p[3] - p[0]);
        const float length_of_sum = length(sum);
        if (!(length_of_sum > 0) || !std::isfinite(length_of_sum)) return;
        part.area = length_of_sum / 2;
        part.normal = one_of_two(sum / length_of_sum);
        if (!normals.empty())
            for (uint32_t corner : corners) {
                const Vec3 own = normalize(shape.object_to_world.start().normal(normals[corner]));
                if (!(length(cross(own, part.normal)) < kMostTilt)) return;
            }
        for (size_t i = 0; n == 4 && i < n; ++i) {
            const Vec3 a = p[i], b = p[(i + 1) % n], c = p[(i + 2) % n];
            if (!(dot(cross(b - a, c - b), sum) > 0) ||
                std::abs(dot(a - p[0], part.normal)) > kMostTilt * size_of(part))
                return;
        }
        parts_.push_back(part);
    }

    const SceneDescription& scene_;
    const Geometry& geometry_;
    std::vector<Part> parts_;
};

void keep_largest(std::vector<Part>& parts) {
    if (parts.size() <= kMostParts) return;
    const auto comes_first = [](const Part& a, const Part& b) {
        const float size_a = a.area * a.brightness, size_b = b.area * b.brightness;
        return std::tie(size_b, a.shape, a.primitive) < std::tie(size_a, b.shape, b.primitive);
    };
    std::nth_element(parts.begin(), parts.begin() + kMostParts, parts.end(), comes_first);
    parts.resize(kMostParts);
    std::sort(parts.begin(), parts.end(), comes_first);
}

/// The rectangle around parts that lie in the plane of the first of them, which is the largest.
FlatMirror rectangle_around(const std::vector<const Part*>& parts) {
    const Part& first = *parts.front();
    const Frame frame =
        Frame::from_z_x(first.normal, normalize(first.corners()[1] - first.corners()[0]));
    const Vec3 origin = first.corners()[0];
    Vec2 least{kInfinity, kInfinity}, most{-kInfinity, -kInfinity};
    float bright = 0;
    for (const Part* part : parts) {
        bright += part->area * part->brightness;
        for (Vec3 corner : part->corners()) {
            const Vec3 local = frame.to_local(corner - origin);
            least = {std::min(least.x, local.x), std::min(least.y, local.y)};
            most = {std::max(most.x, local.x), std::max(most.y, local.y)};
        }
    }
    const Vec2 middle = (least + most) * 0.5f, half = (most - least) * 0.5f;
    FlatMirror mirror;
    mirror.normal = frame.z;
    mirror.center = origin + frame.x * middle.x + frame.y * middle.y;
    mirror.x = frame.x * half.x;
    mirror.y = frame.y * half.y;
    mirror.brightness = bright / mirror.area();
    if (parts.size() > kMostTriangles / 2) return mirror;
    const auto share = [&](Vec3 corner) {
        const Vec3 local = frame.to_local(corner - mirror.center);
        return Vec2{local.x / half.x, local.y / half.y};
    };
    for (const Part* part : parts)
        for (size_t i = 2; i < part->corners().size(); ++i)
            mirror.triangles.push_back({share(part->corners()[0]), share(part->corners()[i - 1]),
                                        share(part->corners()[i])});
    return mirror;
}

}  // namespace

std::optional<float> FlatMirror::crossing(Vec3 origin, Vec3 direction) const {
    const float t = dot(center - origin, normal) / dot(direction, normal);
    if (!(t > 0) || !std::isfinite(t)) return std::nullopt;
    const Vec3 q = origin + direction * t - center;
    if (!may_hold({dot(q, x) / length_squared(x), dot(q, y) / length_squared(y)}))
        return std::nullopt;
    return t;
}

bool FlatMirror::may_hold(Vec2 place) const {
    constexpr float kMargin = 1e-3f;
    if (std::abs(place.x) > 1 + kMargin || std::abs(place.y) > 1 + kMargin) return false;
    const auto area = [](Vec2 a, Vec2 b, Vec2 c) {
        return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    };
    return triangles.empty() || std::any_of(triangles.begin(), triangles.end(), [&](const auto& t) {
               const float least = -kMargin * std::abs(area(t[0], t[1], t[2]));
               const float sign = area(t[0], t[1], t[2]) < 0 ? -1.0f : 1.0f;
               return sign * area(t[0], t[1], place) >= least &&
                      sign * area(t[1], t[2], place) >= least &&
                      sign * area(t[2], t[0], place) >= least;
           });
}

FlatMirrors::FlatMirrors(const SceneDescription& scene, const Geometry& geometry) {
    std::vector<Part> parts = PartFinder(scene, geometry).find();
    if (parts.empty()) return;
    keep_largest(parts);
    // Sort parts by their planes
    Bounds3 bounds;
    for (const Part& part : parts)
        for (Vec3 corner : part.corners()) bounds.extend(corner);
    const float extent = bounds.radius();
    std::map<std::array<int, 4>, std::vector<const Part*>> planes;
    for (const Part& part : parts) {
        const auto step = [](float v) { return int(std::lround(v / kSortStep)); };
        const float height = dot(part.corners()[0] - bounds.center(), part.normal) / extent;
        planes[{step(part.normal.x), step(part.normal.y), step(part.normal.z), step(height)}]
            .push_back(&part);
    }
    // Take what lies in one plane: first those in the plane of the largest, then those of the rest,
    // as parallel planes beside each other share a step
    struct Found {
        FlatMirror mirror;
        std::vector<const Part*> parts;
    };
    std::vector<Found> found;
    for (auto& [key, all] : planes) {
        std::stable_sort(all.begin(), all.end(),
                         [](const Part* a, const Part* b) { return a->area > b->area; });
        for (size_t planes_of_step = 0; planes_of_step < kMost && !all.empty(); ++planes_of_step) {
            const Part& first = *all.front();
            const auto rest = std::stable_partition(
                std::next(all.begin()), all.end(),
                [&](const Part* part) { return lies_in_plane_of(first, *part); });
            const std::vector<const Part*> plane(all.begin(), rest);
            found.push_back({rectangle_around(plane), plane});
            all.erase(all.begin(), rest);
        }
    }
    // Keep the largest
    const auto size = [](const Found& f) { return f.mirror.area() * f.mirror.brightness; };
    std::stable_sort(found.begin(), found.end(),
                     [&](const Found& a, const Found& b) { return size(a) > size(b); });
    const float least = kLeastArea * size(found.front());
    mirror_of_.resize(geometry.shapes().size());
    for (const Found& f : found) {
        if (mirrors_.size() == kMost || size(f) < least) break;
        for (const Part* part : f.parts) {
            auto& of_shape = mirror_of_[part->shape];
            if (of_shape.size() <= part->primitive) of_shape.resize(part->primitive + 1, -1);
            of_shape[part->primitive] = int8_t(mirrors_.size());
        }
        mirrors_.push_back(f.mirror);
    }
}

float FlatMirrors::weight(const FlatMirror& m, Vec3 p, Vec3 n) const {
    const Vec3 to = m.center - p;
    // Leave out mirrors that are wholly behind the surface, or seen edge on
    if (n != Vec3{} && !(dot(n, to) + std::abs(dot(n, m.x)) + std::abs(dot(n, m.y)) > 0)) return 0;
    const float height = std::abs(dot(to, m.normal)), area = m.area();
    const float squared = length_squared(to) + area / 4;
    if (!(height * height > 1e-8f * squared)) return 0;
    return m.brightness * area * height / (squared * std::sqrt(squared));
}

std::optional<FlatMirrors::Choice> FlatMirrors::choose(Vec3 p, Vec3 n, float& u) const {
    std::array<float, kMost> weights{};
    float total = 0;
    for (size_t i = 0; i < mirrors_.size(); ++i) total += weights[i] = weight(mirrors_[i], p, n);
    if (!(total > 0)) return std::nullopt;
    float place = u * total;
    size_t last = 0;
    for (size_t i = 0; i < mirrors_.size(); ++i) {
        if (!(weights[i] > 0)) continue;
        last = i;
        if (place < weights[i]) break;
        if (i + 1 < mirrors_.size()) place -= weights[i];
    }
    u = std::min(std::max(place / weights[last], 0.0f), 0x1.fffffep-1f);
    return Choice{int(last), weights[last] / total};
}

float FlatMirrors::probability(int mirror, Vec3 p, Vec3 n) const {
    float total = 0;
    for (const FlatMirror& m : mirrors_) total += weight(m, p, n);
    return total > 0 ? weight(mirrors_[size_t(mirror)], p, n) / total : 0;
}

}  // namespace covtrace
