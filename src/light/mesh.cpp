#include "light/mesh.h"

#include <algorithm>
#include <cmath>

#include "core/warp.h"
#include "geometry/bilinear_patch.h"
#include "light/spherical_triangle.h"

namespace covtrace {

namespace {

/// Range of solid angles, steradians, in which triangles are sampled by solid angle, about that of
/// pbrt-v4. Smaller ones are sampled as well by area, which loses fewer digits; a larger one is
/// nearly a hemisphere, 2 pi, where the point all but lies in the triangle.
constexpr float kSmallestSolidAngle = 3e-4f, kLargestSolidAngle = 6.2f;

/// Twist of a patch, relative to its diagonals, that is left out as the roundings of a
/// parallelogram.
constexpr double kRoundedTwist = 1e-5;

bool by_solid_angle(float solid_angle) {
    return solid_angle >= kSmallestSolidAngle && solid_angle <= kLargestSolidAngle;
}

/// Barycentric coordinates (b1, b2) of the point where the ray from p along w meets the triangle's
/// plane, moved into the triangle.
Vec2 barycentric(const WorldTriangle& t, Vec3 p, Vec3 w) {
    const Vec3 e1 = t.p1 - t.p0, e2 = t.p2 - t.p0, s = p - t.p0;
    const Vec3 s1 = cross(w, e2);
    const float divisor = dot(s1, e1);
    if (divisor == 0) return {1.0f / 3, 1.0f / 3};
    const float scale = 1 / divisor;
    const Vec2 b{clamp01(dot(s, s1) * scale), clamp01(dot(w, cross(s, e1)) * scale)};
    const float sum = b.x + b.y;
    return sum > 1 ? b * (1 / sum) : b;
}

/// (u, v) in the patch of a half of it, a light, of whose barycentric coordinates b are.
Vec2 place_on_patch(int light, Vec2 b) {
    return light & 1 ? Vec2{1 - b.x, 1 - b.y} : b;
}
/// The bilinear mean of the values of a patch's corners there.
template <typename T>
T value_on_patch(const BilinearMesh& mesh, const std::vector<T>& values, int light, Vec2 b) {
    const auto& k = mesh.patches[static_cast<size_t>(light / 2)];
    const Vec2 at = place_on_patch(light, b);
    return (values[k[0]] * (1 - at.x) + values[k[1]] * at.x) * (1 - at.y) +
           (values[k[2]] * (1 - at.x) + values[k[3]] * at.x) * at.y;
}

}  // namespace

EmissiveMesh::EmissiveMesh(const Geometry& geometry, uint32_t shape)
    : mesh_(geometry.shapes()[shape].description.geometry), geometry_(&geometry), shape_(shape) {
    const ShapeDescription& description = geometry.shapes()[shape].description;
    if (description.object_to_world.is_animated()) {
        motion_ = &description.object_to_world;
        moves_ = geometry.moves(shape);
    }
    const Transform placed = motion_ ? Transform() : description.object_to_world.start();
    const bool reverse = description.reverse_orientation;
    const float winding = reverse != placed.swaps_handedness() ? -1.0f : 1.0f;
    const auto add = [&](const auto& mesh, uint32_t i0, uint32_t i1, uint32_t i2, Vec3 twist,
                         Vec3 left_out) {
        Element e;
        e.left_out = left_out;
        e.p0 = placed.point(mesh.positions[i0]);
        e.p1 = placed.point(mesh.positions[i1]);
        e.p2 = placed.point(mesh.positions[i2]);
        e.twist = twist;
        e.facing = {winding, winding, winding};
        if (!mesh.normals.empty()) {
            // Vertex normals decide which side is outside, as in pbrt.
            const Vec3 n = cross(e.p1 - e.p0, e.p2 - e.p0) * (reverse ? -1.0f : 1.0f);
            e.facing = {dot(n, placed.normal(mesh.normals[i0])),
                        dot(n, placed.normal(mesh.normals[i1])),
                        dot(n, placed.normal(mesh.normals[i2]))};
        }
        e.normal = normalize(cross(e.p1 - e.p0, e.p2 - e.p0));
        elements_.push_back(e);
    };
    if (const auto* triangles =
            std::get_if<std::shared_ptr<const TriangleMesh>>(&description.geometry)) {
        elements_.reserve((*triangles)->triangles.size());
        for (const auto& t : (*triangles)->triangles) add(**triangles, t[0], t[1], t[2], {}, {});
        return;
    }
    is_patches_ = true;
    const auto& mesh = *std::get<std::shared_ptr<const BilinearMesh>>(description.geometry);
    elements_.reserve(2 * mesh.patches.size());
    const auto patch = [&](const std::array<uint32_t, 4>& k) {
        const auto corner = [&](size_t i) { return Vec3d(placed.point(mesh.positions[k[i]])); };
        return BilinearPatch{corner(0), corner(1), corner(2), corner(3)};
    };
    const bool are_parallelograms =
        std::all_of(mesh.patches.begin(), mesh.patches.end(),
                    [&](const auto& k) { return is_parallelogram(patch(k)); });
    for (const auto& k : mesh.patches) {
        const BilinearPatch p = patch(k);
        Vec3 twist = p.twist().to_float();
        const double size = std::max(length(p.p11 - p.p00), length(p.p10 - p.p01));
        Vec3 left_out;
        // A patch with no more twist than rounding leaves is a parallelogram, which is flat.
        if (are_parallelograms || double(length(twist)) <= kRoundedTwist * size) {
            left_out = twist;
            twist = {};
        }
        add(mesh, k[0], k[1], k[2], twist, left_out);
        add(mesh, k[3], k[2], k[1], twist, left_out);
    }
}

int EmissiveMesh::light_of(const SurfaceHit& hit) const {
    if (!is_patches_) return static_cast<int>(hit.primitive);
    const bool second = hit.barycentric.x + hit.barycentric.y > 1;
    return static_cast<int>(2 * hit.primitive + (second ? 1 : 0));
}

EmissiveMesh::Element EmissiveMesh::moved(Element e, const Affine& map) {
    const auto point = [&](Vec3 p) { return map.point(Vec3d(p)).to_float(); };
    e.p0 = point(e.p0), e.p1 = point(e.p1), e.p2 = point(e.p2);
    e.twist = map.vector(Vec3d(e.twist)).to_float();
    e.left_out = map.vector(Vec3d(e.left_out)).to_float();
    if (map.determinant() < 0) e.facing = -e.facing;
    e.normal = normalize(cross(e.p1 - e.p0, e.p2 - e.p0));
    return e;
}

EmissiveMesh::Element EmissiveMesh::at(int light, float time) const {
    const Element& e = elements_[static_cast<size_t>(light)];
    return motion_ ? moved(e, geometry_->world_from_object(shape_, time)) : e;
}

float EmissiveMesh::area_pdf(const Element& e, Vec3 p, Vec3 position, Vec2 b) {
    // (b1, b2) is uniform in a triangle of area 1/2, so its density is 2; an area element of the
    // surface is |d1 x d2| times that of (b1, b2).
    const Vec3 n = cross(e.d1(b), e.d2(b)), to_point = position - p;
    const float distance_squared = length_squared(to_point);
    const float projected = abs_dot(n, to_point);  // |n| distance cos
    const float pdf = 2 * distance_squared * std::sqrt(distance_squared) / projected;
    return std::isfinite(pdf) ? pdf : 0.0f;
}

std::optional<EmitterPoint> EmissiveMesh::sample(int light, Vec3 p, float time, Vec2 u) const {
    const Element& own = elements_[static_cast<size_t>(light)];
    std::optional<Affine> map;
    if (motion_) map = geometry_->world_from_object(shape_, time);
    const Element e = map ? moved(own, *map) : own;
    EmitterPoint s;
    Vec2 b;
    float solid_angle = 0;
    if (e.is_flat()) {
        const WorldTriangle triangle{e.p0, e.p1, e.p2};
        const SphericalTriangle t = spherical_triangle(triangle, p);
        solid_angle = t.solid_angle;
        if (by_solid_angle(solid_angle)) b = barycentric(triangle, p, sample_direction(t, u));
    }
    if (!by_solid_angle(solid_angle)) b = square_to_triangle(u);
    s.place = b;
    s.position = e.point(b);
    const Vec3 to_point = s.position - p;
    if (!(length_squared(to_point) > 0)) return std::nullopt;
    s.wi = normalize(to_point);
    s.pdf = by_solid_angle(solid_angle) ? 1 / solid_angle : area_pdf(e, p, s.position, b);
    if (!(s.pdf > 0)) return std::nullopt;
    const float facing = e.facing.x * (1 - b.x - b.y) + e.facing.y * b.x + e.facing.z * b.y;
    const Vec3 normal = e.is_flat() ? e.normal : normalize(cross(e.d1(b), e.d2(b)));
    s.normal = facing < 0 ? -normal : normal;
    find_place(own, e, map, p, b, s);
    return s;
}

void EmissiveMesh::find_place(const Element& own, const Element& e,
                              const std::optional<Affine>& map, Vec3 p, Vec2 b,
                              EmitterPoint& point) const {
    const float size =
        std::sqrt(std::max(length_squared(e.p1 - e.p0), length_squared(e.p2 - e.p0)));
    point.unrounded = e.unrounded_point(b);
    point.error = meeting_error(double(size), double(distance(p, point.position))) +
                  double(abs_dot(e.left_out, point.normal) * b.x * b.y);
    if (!moves_) return;
    // Rays meet what moves in its own space, where its corners have not been rounded again
    point.unrounded = map->point(own.unrounded_point(b));
    point.error +=
        kUsualInstanceRoundings *
        instance_rounding(*map, map->inverse(), Vec3d(point.normal), Vec3d(p), point.unrounded);
}

float EmissiveMesh::pdf(int light, Vec3 p, const SurfaceHit& hit) const {
    const Element e = at(light, hit.time);
    if (e.is_flat()) {
        const float solid_angle = spherical_triangle({e.p0, e.p1, e.p2}, p).solid_angle;
        if (by_solid_angle(solid_angle)) return 1 / solid_angle;
    }
    Vec2 b = hit.barycentric;
    // The second half of a patch counts from the opposite corner.
    if (is_patches_ && (light & 1)) b = {1 - b.x, 1 - b.y};
    return area_pdf(e, p, hit.position, b);
}

Vec2 EmissiveMesh::uv(int light, const EmitterPoint& point, float) const {
    const Vec2 b = point.place;
    if (const auto* triangles = std::get_if<std::shared_ptr<const TriangleMesh>>(&mesh_)) {
        const auto uvs = uv_corners(**triangles, static_cast<uint32_t>(light));
        return uvs[0] * (1 - b.x - b.y) + uvs[1] * b.x + uvs[2] * b.y;
    }
    const auto& mesh = *std::get<std::shared_ptr<const BilinearMesh>>(mesh_);
    if (mesh.uvs.empty()) return place_on_patch(light, b);
    return value_on_patch(mesh, mesh.uvs, light, b);
}

Vec3 EmissiveMesh::shading_normal(int light, const EmitterPoint& point, float time) const {
    const Vec2 b = point.place;
    Vec3 n;
    if (const auto* triangles = std::get_if<std::shared_ptr<const TriangleMesh>>(&mesh_)) {
        const TriangleMesh& mesh = **triangles;
        if (mesh.normals.empty()) return point.normal;
        const auto& k = mesh.triangles[static_cast<size_t>(light)];
        n = mesh.normals[k[0]] * (1 - b.x - b.y) + mesh.normals[k[1]] * b.x +
            mesh.normals[k[2]] * b.y;
    } else {
        const auto& mesh = *std::get<std::shared_ptr<const BilinearMesh>>(mesh_);
        if (mesh.normals.empty()) return point.normal;
        n = value_on_patch(mesh, mesh.normals, light, b);
    }
    const Vec3d turned = normalize(geometry_->world_from_object(shape_, time).normal(Vec3d(n)));
    return dot(turned, turned) > 0.5 ? turned.to_float() : point.normal;
}

VertexPlace EmissiveMesh::vertices(int light, const EmitterPoint& point) const {
    const auto* triangles = std::get_if<std::shared_ptr<const TriangleMesh>>(&mesh_);
    if (!triangles || !has_vertex_values(**triangles)) return {};
    return {triangles->get(), static_cast<uint32_t>(light), point.place};
}

std::array<Vec3, 3> EmissiveMesh::start_corners(int light) const {
    const Element& e = elements_[static_cast<size_t>(light)];
    if (!motion_) return {e.p0, e.p1, e.p2};
    const Transform& t = motion_->start();
    return {t.point(e.p0), t.point(e.p1), t.point(e.p2)};
}

float EmissiveMesh::area(int light) const {
    Element e = elements_[static_cast<size_t>(light)];
    if (motion_) e = moved(e, Affine::from_matrix(motion_->start().matrix()));
    if (e.is_flat()) return 0.5f * length(cross(e.p1 - e.p0, e.p2 - e.p0));
    // The area is summed by the midpoint rule over small squares of (b1, b2); those on the diagonal
    // b1 + b2 = 1 are half inside and count half.
    constexpr int kSteps = 32;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; i + j < kSteps; ++j) {
            const Vec2 b{(float(i) + 0.5f) / kSteps, (float(j) + 0.5f) / kSteps};
            sum += (i + j == kSteps - 1 ? 0.5 : 1.0) * length(cross(e.d1(b), e.d2(b)));
        }
    return static_cast<float>(sum / (kSteps * kSteps));
}

LightBounds EmissiveMesh::bounds(int light) const {
    const Element& element = elements_[static_cast<size_t>(light)];
    LightBounds bounds;
    MotionBox motion_box;
    bool first = true;
    const bool both_sides =
        std::min(element.facing.x, std::min(element.facing.y, element.facing.z)) < 0 &&
        std::max(element.facing.x, std::max(element.facing.y, element.facing.z)) > 0;
    for (const Transform& t : motion_ ? poses_over_time(*motion_) : std::vector<Transform>(1)) {
        const Element e = motion_ ? moved(element, Affine::from_matrix(t.matrix())) : element;
        // The fourth corner of the whole patch bounds its half, too.
        motion_box.add({e.p0, e.p1, e.p2, e.is_flat() ? e.p0 : e.point({1, 1})});
        const float side = e.facing.x + e.facing.y + e.facing.z < 0 ? -1.0f : 1.0f;
        // The normal d1 x d2 is linear in (b1, b2): the normals at the corners bound all others.
        for (const Vec2 corner : {Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}}) {
            LightBounds cone;
            cone.intensity = 1;
            cone.axis = normalize(cross(e.d1(corner), e.d2(corner))) * side;
            if (cone.axis == Vec3{}) continue;
            bounds = first ? cone : merge(bounds, cone);
            first = false;
            if (e.is_flat()) break;
        }
    }
    bounds.box = motion_box.box();
    bounds.intensity = first ? 0.0f : area(light);
    bounds.two_sided = both_sides;
    return bounds;
}

}  // namespace covtrace
