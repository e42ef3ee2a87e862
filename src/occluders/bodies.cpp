#include "occluders/bodies.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

namespace covtrace {

namespace {

/// Triangles that curved shapes may have together, as far as pieces of a circle between the two
/// bounds allow (docs/decisions/0014): a sphere has at least 256.
constexpr double kCurvedTriangles = 2e6;
constexpr double kMostAround = 64, kLeastAround = 16;
/// Instances that are looked at between two calls of `cancelled`.
constexpr ptrdiff_t kInstancesAtOnce = 1024;
/// Triangles that flat shapes with alpha may have together, and bounds on the pieces that an edge
/// of theirs is cut into for them (docs/decisions/0043).
constexpr double kPerforatedTriangles = 2e6;
constexpr int kMostPerEdge = 64, kLeastPerEdge = 4;
/// Alpha above which a surface occludes. The edge of a surface that lets the share t of the light
/// through has the contrast (1 - t) / (1 + t). With t = 1 - 0.18 that is a tenth, and edges of this
/// contrast and more count in full (covariance::edge_visibility).
constexpr float kOpaque = 0.18f;

/// The factor on lengths of a map that is a similarity (it scales all directions alike); 0 for any
/// other map.
double similarity(const Affine& m) {
    const double s = length(m.row[0]);
    const auto is = [s](double value, double expected) {
        return std::abs(value - expected) <= 1e-5 * s * s;
    };
    const bool keeps = is(dot(m.row[1], m.row[1]), s * s) && is(dot(m.row[2], m.row[2]), s * s) &&
                       is(dot(m.row[0], m.row[1]), 0) && is(dot(m.row[1], m.row[2]), 0) &&
                       is(dot(m.row[2], m.row[0]), 0);
    return keeps ? s : 0;
}

/// The body of a shape that is a whole sphere and round in local space; none for other shapes.
std::optional<OccluderBody> ball_of(const LocalShape& shape) {
    const auto* q = std::get_if<Quadric>(&shape);
    if (!q || q->kind != Quadric::Kind::sphere || q->z_min > -q->radius || q->z_max < q->radius ||
        q->phi_max < 6.2831853)
        return std::nullopt;
    OccluderBody body;
    body.kind = OccluderBody::Kind::moving_ball;
    body.center = q->local_from_object.translation.to_float();
    body.radius = static_cast<float>(q->radius * similarity(q->local_from_object));
    return body.radius > 0 ? std::optional(body) : std::nullopt;
}

/// Number of triangles of a flat shape.
size_t triangle_count(const LocalShape& shape) {
    if (const auto* mesh = std::get_if<TriangleShape>(&shape)) return mesh->mesh->triangles.size();
    return 2 * std::get<PatchShape>(shape).mesh->patches.size();
}

Bounds3 bounds_of_ball(Vec3 center, float radius) {
    const Vec3 r = Vec3{1, 1, 1} * (1.00001f * radius);
    return {center - r, center + r};
}

Bounds3 transformed(const Bounds3& b, const Affine& map) {
    const Vec3d c = map.point(Vec3d(b.center())), h = map.absolute(Vec3d(b.diagonal() * 0.5f));
    Bounds3 r;
    // The box grows by 1e-5 of itself, which covers the rounding to single precision at places up
    // to a hundred times its half size from the origin.
    r.extend((c - h * 1.00001).to_float());
    r.extend((c + h * 1.00001).to_float());
    return r;
}

}  // namespace

OccluderBodies::OccluderBodies(const Geometry::Impl& g, std::function<bool()> cancelled)
    : geometry(g), cancelled_(std::move(cancelled)) {
    size_t curved = 0;
    for (const LocalShape& shape : g.local)
        if (!is_flat(shape)) ++curved;
    // A sphere has around^2 triangles: two per cell, and half as many cells along as around.
    around_ = std::clamp(std::sqrt(kCurvedTriangles / std::max<double>(1, double(curved))),
                         kLeastAround, kMostAround);
    double perforated = 0;
    for (size_t i = 0; i < g.local.size(); ++i)
        if (has_holes(static_cast<uint32_t>(i)) && is_flat(g.local[i]))
            perforated += static_cast<double>(triangle_count(g.local[i]));
    // With a power of two the pieces of neighbours have the same corners (PiercedTriangle).
    per_edge_ = static_cast<int>(std::bit_floor(static_cast<unsigned>(std::min<double>(
        std::sqrt(kPerforatedTriangles / std::max(1.0, perforated)), kMostPerEdge))));
    using Kind = OccluderBody::Kind;
    const std::vector<bool> deformed = deformed_scenes();
    std::vector<std::vector<OccluderBody>> of_scene(g.scenes.size());
    std::vector<OccluderBall> still;
    for (const EmbreeInstance& instance : g.instances) {
        if ((&instance - g.instances.data()) % kInstancesAtOnce == 0 && is_cancelled()) break;
        auto& parts = of_scene[instance.scene];
        if (parts.empty())
            parts = add(g.scenes[instance.scene].shape_of_geometry,
                        g.world_from_local(instance, g.clock.open()), deformed[instance.scene]);
        for (OccluderBody part : parts) {
            part.instance = &instance;
            if (part.curved.shape != Owner::kNone)
                part.curved.instance = static_cast<uint32_t>(&instance - g.instances.data()) + 1;
            const bool is_ball = part.kind == Kind::moving_ball;
            if (is_ball && deformed[instance.scene] && !keeps_angles(instance))
                part.kind = Kind::edges;
            else if (is_ball && !instance.moves) {
                still.push_back(moved(part, g.clock.open()));
                continue;
            }
            bodies.push_back(part);
        }
    }
    // The top scene starts with the instances themselves, so its own shapes come after these.
    const auto& top = g.top.shape_of_geometry;
    for (const OccluderBody& part :
         add({top.begin() + static_cast<ptrdiff_t>(g.instances.size()), top.end()}, {}, false)) {
        if (part.kind == Kind::moving_ball)
            still.push_back({part.center, part.radius, part.curved});
        else
            bodies.push_back(part);
    }
    if (is_cancelled()) {
        // Half of the occluders are no better than none, and their hierarchies take longest.
        bodies.clear();
        return;
    }
    add_balls(still);
    std::vector<Bounds3> boxes;
    for (const OccluderBody& body : bodies) boxes.push_back(bounds_of(body));
    hierarchy = BoxHierarchy(boxes, 1, cancelled_);
    std::vector<OccluderBody> ordered;
    for (size_t i = 0; i < hierarchy.items(); ++i) ordered.push_back(bodies[hierarchy.item(i)[0]]);
    bodies = std::move(ordered);
}

std::vector<bool> OccluderBodies::deformed_scenes() const {
    std::vector<bool> deformed(geometry.scenes.size(), false), has_balls = deformed;
    for (size_t i = 0; i < has_balls.size(); ++i)
        for (uint32_t shape : geometry.scenes[i].shape_of_geometry)
            has_balls[i] = has_balls[i] || ball_of(geometry.local[shape]);
    for (const EmbreeInstance& instance : geometry.instances)
        if (has_balls[instance.scene] && !deformed[instance.scene])
            deformed[instance.scene] = !keeps_angles(instance);
    return deformed;
}

/// Makes bodies of balls that do not move: blocks of those that stand together.
void OccluderBodies::add_balls(const std::vector<OccluderBall>& all) {
    std::vector<Bounds3> boxes(all.size());
    for (size_t i = 0; i < all.size(); ++i) boxes[i] = bounds_of_ball(all[i].center, all[i].radius);
    const BoxHierarchy groups(boxes, BoxHierarchy::kWidth, cancelled_);
    for (size_t i = 0; i < groups.items(); ++i) {
        std::vector<OccluderBall> block;
        for (uint32_t k : groups.item(i)) block.push_back(all[k]);
        OccluderBody body;
        body.kind = OccluderBody::Kind::balls;
        body.index = static_cast<uint32_t>(balls.size());
        balls.emplace_back(block);
        bodies.push_back(body);
    }
}

OccluderBall OccluderBodies::moved(const OccluderBody& body, float time) const {
    const Affine map = geometry.world_from_local(*body.instance, time);
    const auto scale = static_cast<float>(length(map.row[0]));
    return {map.point(Vec3d(body.center)).to_float(), body.radius * scale, body.curved};
}

/// Whether an instance's map is a similarity throughout the shutter, as far as its ends and its
/// middle tell.
bool OccluderBodies::keeps_angles(const EmbreeInstance& instance) const {
    const float open = geometry.clock.open(), close = geometry.clock.close();
    for (const float time : {open, 0.5f * (open + close), close})
        if (!(similarity(geometry.world_from_local(instance, time)) > 0)) return false;
    return true;
}

bool OccluderBodies::has_holes(uint32_t shape) const {
    return geometry.placed[shape].description.alpha >= 0 && geometry.alpha;
}

/// A flat shape with the holes that alpha makes. Alpha that depends on the place in the world is
/// looked up where `world_from_local` puts the shape.
OccluderSurface OccluderBodies::flat_surface(uint32_t shape, const Affine& world_from_local) const {
    const LocalShape& local = geometry.local[shape];
    OccluderSurface surface{Tessellation(local, 1, 1)};
    if (!has_holes(shape) || per_edge_ < kLeastPerEdge) return surface;
    const TextureId texture = geometry.placed[shape].description.alpha;
    const auto is_opaque = [this, texture, world_from_local](const SurfacePoint& p) {
        const Vec3 at = world_from_local.point(p.position).to_float();
        const Vec3 normal = normalize(world_from_local.normal(p.ng)).to_float();
        return geometry.alpha(texture, {p.uv, at, p.vertices, normal}) > kOpaque;
    };
    surface.holes = {&local, is_opaque, per_edge_, sizeof is_opaque};
    return surface;
}

/// Makes bodies of the shapes of one of Embree's scenes: one edge set for all flat shapes together,
/// a ball for each whole sphere, an edge set for each other curved shape. With `are_deformed` a
/// sphere gets an edge set as well, for the instances that make an ellipsoid of it.
std::vector<OccluderBody> OccluderBodies::add(const std::vector<uint32_t>& shapes,
                                              const Affine& world_from_local, bool are_deformed) {
    std::vector<OccluderSurface> flat;
    std::vector<OccluderBody> parts;
    for (uint32_t shape : shapes) {
        if (is_cancelled()) break;
        if (!geometry.is_in_the_way[shape]) continue;
        const LocalShape& local = geometry.local[shape];
        if (is_flat(local)) {
            flat.push_back(flat_surface(shape, world_from_local));
            continue;
        }
        OccluderBody body = ball_of(local).value_or(OccluderBody());
        body.curved = {shape, 0};
        if (body.kind == OccluderBody::Kind::moving_ball && !are_deformed) {
            parts.push_back(body);
            continue;
        }
        std::vector<OccluderSurface> curved;
        curved.push_back({Tessellation(local, piece_of(local), 1)});
        keep(std::move(curved), body, parts);
    }
    keep(std::move(flat), {}, parts);
    return parts;
}

/// Adds to `parts` a body like `body` with the edges of surfaces, if there may be any.
void OccluderBodies::keep(std::vector<OccluderSurface> surfaces, const OccluderBody& body,
                          std::vector<OccluderBody>& parts) {
    const EdgeClusters& clusters = sets.emplace_back(std::move(surfaces));
    if (clusters.hierarchy().empty()) {
        sets.pop_back();
        return;
    }
    parts.push_back(body);
    parts.back().index = static_cast<uint32_t>(sets.size() - 1);
}

/// Length of a curved shape's tessellation pieces, in local space: around_ of them make the widest
/// circle of a quadric, a quarter of that the diagonal of other shapes' bounding box.
double OccluderBodies::piece_of(const LocalShape& shape) const {
    Bounds3 b;
    if (const auto* quadric = std::get_if<Quadric>(&shape)) {
        const Affine& m = quadric->local_from_object;
        const double widest = std::max({length(m.row[0]), length(m.row[1]), length(m.row[2])});
        return 2 * double(kPi) * quadric->radius * widest / around_;
    }
    for (Vec3 p : std::get<PatchShape>(shape).positions) b.extend(p);
    return std::max(4 * double(length(b.diagonal())) / around_, 1e-30);
}

Bounds3 OccluderBodies::bounds_of(const OccluderBody& body) const {
    if (body.kind == OccluderBody::Kind::balls) {
        const BallBlock& block = balls[body.index];
        Bounds3 all;
        for (size_t k = 0; k < BoxHierarchy::kWidth; ++k)
            if (block.radius[k] > 0)
                all.extend(bounds_of_ball({block.center.x[k], block.center.y[k], block.center.z[k]},
                                          block.radius[k]));
        return all;
    }
    const Bounds3 local = body.kind == OccluderBody::Kind::moving_ball
                              ? bounds_of_ball(body.center, body.radius)
                              : sets[body.index].hierarchy().bounds();
    if (!body.instance) return local;
    if (!body.instance->moves) return transformed(local, body.instance->still);
    // A moving body's corners go along curves between two times: its bounds are the boxes at many
    // times, with half a step of room for the way between.
    constexpr int kTimes = 32;
    const ShutterClock& clock = geometry.clock;
    Bounds3 all, before;
    for (int i = 0; i <= kTimes; ++i) {
        const float f = static_cast<float>(i) / kTimes;
        const float time = clock.open() + f * (clock.close() - clock.open());
        const Bounds3 now = transformed(local, geometry.world_from_local(*body.instance, time));
        all.extend(now);
        if (i > 0) {
            const Vec3 step = max(max(now.lo - before.lo, before.lo - now.lo),
                                  max(now.hi - before.hi, before.hi - now.hi));
            all.extend(Bounds3{now.lo - step * 0.5f, now.hi + step * 0.5f});
        }
        before = now;
    }
    return all;
}

}  // namespace covtrace
