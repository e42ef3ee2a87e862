#include "light/quadric.h"

#include <algorithm>
#include <cmath>

#include "core/frame.h"
#include "core/warp.h"

namespace covtrace {

namespace {

float radians(float degrees) {
    return degrees * (kPi / 180);
}

/// The vector v multiplied by the transpose of the transform's linear part M.
Vec3 transposed_vector(const Transform& t, Vec3 v) {
    const auto& m = t.matrix().m;
    const auto component = [&](size_t c) {
        return static_cast<float>(m[0][c] * v.x + m[1][c] * v.y + m[2][c] * v.z);
    };
    return {component(0), component(1), component(2)};
}

}  // namespace

EmissiveQuadric::Pose EmissiveQuadric::make_pose(const Transform& object_to_world) {
    Pose pose;
    pose.object_to_world = object_to_world;
    const Vec3 x = object_to_world.vector({1, 0, 0}), y = object_to_world.vector({0, 1, 0});
    const Vec3 z = object_to_world.vector({0, 0, 1});
    pose.determinant = std::abs(dot(cross(x, y), z));
    const float lx = length(x), ly = length(y), lz = length(z);
    pose.longest = std::max(lx, std::max(ly, lz));
    const float uneven =
        std::max(std::abs(lx - ly), std::max(std::abs(ly - lz), std::abs(lz - lx)));
    const float skew = std::max(abs_dot(x, y), std::max(abs_dot(y, z), abs_dot(z, x)));
    const float limit = 1e-4f * pose.longest;
    if (uneven < limit && skew < limit * pose.longest) pose.scale = lx;
    return pose;
}

EmissiveQuadric::EmissiveQuadric(const Geometry& geometry, uint32_t shape)
    : geometry_(&geometry), shape_(shape) {
    const ShapeDescription& description = geometry.shapes()[shape].description;
    orientation_ = description.reverse_orientation ? -1.0f : 1.0f;
    start_ = make_pose(description.object_to_world.start());
    if (description.object_to_world.is_animated()) {
        motion_ = &description.object_to_world;
        moves_ = geometry.moves(shape);
    }
    if (const auto* s = std::get_if<Sphere>(&description.geometry)) {
        radius_ = s->radius;
        phi_max_ = radians(std::clamp(s->phi_max, 0.0f, 360.0f));
        z_min_ = std::clamp(std::min(s->z_min, s->z_max), -radius_, radius_);
        z_max_ = std::clamp(std::max(s->z_min, s->z_max), -radius_, radius_);
    } else {
        const Disk& d = std::get<Disk>(description.geometry);
        is_sphere_ = false;
        radius_ = d.radius;
        phi_max_ = radians(std::clamp(d.phi_max, 0.0f, 360.0f));
        z_min_ = z_max_ = d.height;
        inner_radius_ = std::clamp(d.inner_radius, 0.0f, radius_);
    }
}

bool EmissiveQuadric::is_whole_sphere() const {
    return is_sphere_ && z_min_ <= -radius_ && z_max_ >= radius_ && phi_max_ >= 2 * kPi * 0.999999f;
}

EmissiveQuadric::ObjectPoint EmissiveQuadric::point(Vec2 u) const {
    const float phi = u.y * phi_max_, c = std::cos(phi), s = std::sin(phi);
    if (is_sphere_) {
        const float z = z_min_ + u.x * (z_max_ - z_min_);
        const float r = safe_sqrt(radius_ * radius_ - z * z);
        return {{r * c, r * s, z}, Vec3{r * c, r * s, z} / radius_};
    }
    const float inner = inner_radius_ * inner_radius_;
    const float r = std::sqrt(inner + u.x * (radius_ * radius_ - inner));
    return {{r * c, r * s, z_min_}, {0, 0, 1}};
}

float EmissiveQuadric::object_area() const {
    if (is_sphere_) return phi_max_ * radius_ * (z_max_ - z_min_);
    return 0.5f * phi_max_ * (radius_ * radius_ - inner_radius_ * inner_radius_);
}

float EmissiveQuadric::area(int) const {
    if (start_.scale > 0) return object_area() * start_.scale * start_.scale;
    // The map M makes an area element |det M| |M^-T n| times as large.
    constexpr int kSteps = 64;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const ObjectPoint at = point({(float(i) + 0.5f) / kSteps, (float(j) + 0.5f) / kSteps});
            sum += length(start_.object_to_world.normal(at.normal));
        }
    return static_cast<float>(sum / (kSteps * kSteps)) * start_.determinant * object_area();
}

LightBounds EmissiveQuadric::bounds(int) const {
    LightBounds bounds;
    MotionBox motion_box;
    bounds.theta_o = is_sphere_ ? kPi : 0;
    Vec3 first_axis;
    for (const Transform& t :
         motion_ ? poses_over_time(*motion_) : std::vector{start_.object_to_world}) {
        std::vector<Vec3> corners;
        for (int i = 0; i < 8; ++i)
            corners.push_back(t.point(
                {i & 1 ? radius_ : -radius_, i & 2 ? radius_ : -radius_, i & 4 ? z_max_ : z_min_}));
        motion_box.add(corners);
        const Vec3 axis = normalize(t.normal({0, 0, orientation_}));
        if (first_axis == Vec3{})
            first_axis = axis;
        else if (dot(axis, first_axis) < 1 - 1e-6f)
            bounds.theta_o = kPi;
    }
    bounds.box = motion_box.box();
    bounds.axis = first_axis;
    // A convex body looks a quarter as large as its surface from any side, on average (Cauchy).
    bounds.intensity = is_whole_sphere() ? area(0) / 4 : area(0);
    return bounds;
}

float EmissiveQuadric::curvature(float time) const {
    if (!is_sphere_) return 0;
    return orientation_ / (radius_ * std::cbrt(pose(time).determinant));
}

bool EmissiveQuadric::seen_as_cone(const Pose& pose, Vec3 p, float& distance_squared) const {
    if (!is_whole_sphere() || !(pose.scale > 0)) return false;
    distance_squared = length_squared(pose.object_to_world.point({}) - p);
    // The limit is a little outside of the sphere: closer than this the cone nears the hemisphere
    // and its rim loses digits.
    const float r = radius_ * pose.scale;
    return distance_squared > r * r * 1.0001f;
}

float EmissiveQuadric::area_pdf(const Pose& pose, Vec3 p, Vec3 position, Vec3 normal) const {
    const Vec3 to_point = position - p;
    const float distance_squared = length_squared(to_point);
    const float cosine = abs_dot(normal, to_point) / std::sqrt(distance_squared);
    const float world_per_object =
        pose.determinant / length(transposed_vector(pose.object_to_world, normal));
    const float pdf = distance_squared / (cosine * world_per_object * object_area());
    return std::isfinite(pdf) ? pdf : 0.0f;
}

namespace {

/// The value 1 - cos of the half angle under which a sphere is seen.
float one_minus_cos_cone(float radius_squared, float distance_squared) {
    const float sin2 = radius_squared / distance_squared;
    return sin2 / (1 + safe_sqrt(1 - sin2));
}

}  // namespace

std::optional<EmitterPoint> EmissiveQuadric::sample_cone(const Pose& pose, Vec3 p,
                                                         float distance_squared, Vec2 u) const {
    const float r = radius_ * pose.scale;
    const Vec3 center = pose.object_to_world.point({});
    const float sin2_max = r * r / distance_squared,
                rim = one_minus_cos_cone(r * r, distance_squared);
    const Vec3 w = square_to_cone(u, rim);
    const Frame frame = Frame::from_z((center - p) / std::sqrt(distance_squared));
    // The angle at the centre between the directions to p and to the nearer intersection, in a form
    // without cancellation for distant spheres.
    const float sin2 = w.x * w.x + w.y * w.y, sin_theta = std::sqrt(sin2);
    const float cos_alpha = sin2 / std::sqrt(sin2_max) + w.z * safe_sqrt(1 - sin2 / sin2_max);
    const float sin_alpha = safe_sqrt(1 - cos_alpha * cos_alpha);
    const Vec2 around = sin_theta > 0 ? Vec2{w.x / sin_theta, w.y / sin_theta} : Vec2{1, 0};
    const Vec3 outward = frame.to_world({sin_alpha * around.x, sin_alpha * around.y, -cos_alpha});
    EmitterPoint s;
    s.position = center + outward * r;
    s.normal = outward * orientation_;
    const Affine to_object = Affine::from_matrix(pose.object_to_world.inverse_matrix());
    find_place(pose, p, to_object.vector(Vec3d(outward)), s);
    s.wi = normalize(frame.to_world(w));
    s.pdf = cone_pdf(rim);
    return s;
}

void EmissiveQuadric::find_place(const Pose& pose, Vec3 p, Vec3d object,
                                 EmitterPoint& point) const {
    const Affine map = Affine::from_matrix(pose.object_to_world.matrix());
    if (is_sphere_) object = normalize(object) * double(radius_);
    point.unrounded = map.point(object);
    point.error =
        meeting_error(double(radius_ * pose.longest), double(distance(p, point.position)));
    if (!moves_) return;
    const Affine inverse = Affine::from_matrix(pose.object_to_world.inverse_matrix());
    point.error += kUsualInstanceRoundings *
                   instance_rounding(map, inverse, Vec3d(point.normal), Vec3d(p), point.unrounded);
}

std::optional<EmitterPoint> EmissiveQuadric::sample(int, Vec3 p, float time, Vec2 u) const {
    const Pose at_time = pose(time);
    float distance_squared = 0;
    if (seen_as_cone(at_time, p, distance_squared))
        return sample_cone(at_time, p, distance_squared, u);
    const ObjectPoint at = point(u);
    EmitterPoint s;
    s.position = at_time.object_to_world.point(at.position);
    s.normal = normalize(at_time.object_to_world.normal(at.normal)) * orientation_;
    find_place(at_time, p, Vec3d(at.position), s);
    const Vec3 to_point = s.position - p;
    if (!(length_squared(to_point) > 0)) return std::nullopt;
    s.wi = normalize(to_point);
    s.pdf = area_pdf(at_time, p, s.position, s.normal);
    if (!(s.pdf > 0)) return std::nullopt;
    return s;
}

float EmissiveQuadric::pdf(int, Vec3 p, const SurfaceHit& hit) const {
    const Pose at_time = pose(hit.time);
    float distance_squared = 0;
    if (seen_as_cone(at_time, p, distance_squared)) {
        // Samples lie on the nearer side. The inner face of the other one is hit by rays that the
        // sphere lets pass, and by mirrors inside, which show it to places whose image is outside.
        const Vec3 outward = hit.position - at_time.object_to_world.point({});
        if (dot(outward, hit.position - p) > 0) return 0;
        const float r = radius_ * at_time.scale;
        return cone_pdf(one_minus_cos_cone(r * r, distance_squared));
    }
    return area_pdf(at_time, p, hit.position, hit.ng);
}

Vec2 EmissiveQuadric::uv(int, const EmitterPoint& point, float time) const {
    const Vec3 p = pose(time).object_to_world.inverse().point(point.position);
    const float turn = std::atan2(p.y, p.x), phi = turn < 0 ? turn + 2 * kPi : turn;
    const float u = std::min(1.0f, phi / phi_max_);
    if (!is_sphere_)
        return {u,
                clamp01((radius_ - std::sqrt(p.x * p.x + p.y * p.y)) / (radius_ - inner_radius_))};
    const auto polar = [this](float z) { return std::acos(std::clamp(z / radius_, -1.0f, 1.0f)); };
    const float first = polar(z_min_);
    return {u, clamp01((polar(p.z) - first) / (polar(z_max_) - first))};
}

std::array<double, 6> EmissiveQuadric::second_moments() const {
    const double r = radius_;
    if (is_whole_sphere()) return {r * r / 4, 0, 0, r * r / 4, 0, r * r / 4};
    // The moments come by the midpoint rule over (u, v), which is uniform by area; exact for whole
    // disks.
    constexpr int kSteps = 64;
    double mean[3] = {}, square[6] = {};
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const Vec3 q = point({(float(i) + 0.5f) / kSteps, (float(j) + 0.5f) / kSteps}).position;
            for (int a = 0, k = 0; a < 3; ++a) {
                mean[a] += q[a];
                for (int b = a; b < 3; ++b) square[k++] += double(q[a]) * q[b];
            }
        }
    constexpr double kCount = double(kSteps) * kSteps;
    std::array<double, 6> moments{};
    for (int a = 0, k = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b, ++k)
            moments[size_t(k)] = square[k] / kCount - mean[a] * mean[b] / (kCount * kCount);
    return moments;
}

std::optional<Vec3> EmissiveQuadric::nearest_border(Vec3 p) const {
    if (is_sphere_) return std::nullopt;
    p.z = z_min_;
    const float r = std::sqrt(p.x * p.x + p.y * p.y);
    const Vec3 outwards = r > 0 ? Vec3{p.x / r, p.y / r, 0} : Vec3{1, 0, 0};
    const Vec3 height{0, 0, z_min_};
    Vec3 best = outwards * radius_ + height;
    const auto consider = [&](Vec3 q) {
        if (distance(p, q) < distance(p, best)) best = q;
    };
    if (inner_radius_ > 0) consider(outwards * inner_radius_ + height);
    if (phi_max_ < 2 * kPi * 0.999999f)
        for (const float phi : {0.0f, phi_max_}) {
            const Vec3 along{std::cos(phi), std::sin(phi), 0};
            consider(along * std::clamp(dot(p, along), inner_radius_, radius_) + height);
        }
    return best;
}

}  // namespace covtrace
