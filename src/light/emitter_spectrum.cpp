#include "light/emitter_spectrum.h"

#include <cmath>

namespace covtrace {

namespace {

/// Second moments (xx, xy, xz, yy, yz, zz) of a mesh about its centroid, in object space, length^2;
/// `start` takes that space to the world at the start of the shutter. Triangles are weighted by
/// their area in the world.
std::array<double, 6> mesh_moments(const EmissiveMesh& mesh, const Transform& start) {
    const Transform to_object = start.inverse();
    std::array<double, 6> square{};
    std::array<double, 3> mean{};
    double total = 0;
    for (int light = 0; light < mesh.light_count(); ++light) {
        std::array<Vec3, 3> v = mesh.start_corners(light);
        const double area = 0.5 * double(length(cross(v[1] - v[0], v[2] - v[0])));
        for (Vec3& q : v) q = to_object.point(q);
        total += area;
        for (int a = 0, k = 0; a < 3; ++a) {
            const double sum_a = double(v[0][a]) + v[1][a] + v[2][a];
            mean[size_t(a)] += area * sum_a / 3;
            for (int b = a; b < 3; ++b, ++k) {
                // Mean of q_a q_b over a triangle: (sum over corners + the product of the sums)
                // / 12.
                const double sum_b = double(v[0][b]) + v[1][b] + v[2][b];
                double corners = 0;
                for (const Vec3& q : v) corners += double(q[a]) * q[b];
                square[size_t(k)] += area * (corners + sum_a * sum_b) / 12;
            }
        }
    }
    if (!(total > 0)) return {};
    for (int a = 0, k = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b, ++k)
            square[size_t(k)] =
                square[size_t(k)] / total - mean[size_t(a)] * mean[size_t(b)] / (total * total);
    return square;
}

/// The vector v multiplied by the transpose of the transform's linear part.
std::array<double, 3> transposed_vector(const Transform& t, Vec3 v) {
    const auto& m = t.matrix().m;
    std::array<double, 3> r;
    for (size_t c = 0; c < 3; ++c) r[c] = m[0][c] * v.x + m[1][c] * v.y + m[2][c] * v.z;
    return r;
}

/// The value a^T S b for a symmetric S, given as (xx, xy, xz, yy, yz, zz).
double quadratic_form(const std::array<double, 6>& s, const std::array<double, 3>& a,
                      const std::array<double, 3>& b) {
    return a[0] * (s[0] * b[0] + s[1] * b[1] + s[2] * b[2]) +
           a[1] * (s[1] * b[0] + s[3] * b[1] + s[4] * b[2]) +
           a[2] * (s[2] * b[0] + s[4] * b[1] + s[5] * b[2]);
}

}  // namespace

EmitterSpectrum::EmitterSpectrum(const PlacedShape& shape, const Emitter& emitter)
    : shape_(&shape), emitter_(&emitter) {
    if (const auto* quadric = std::get_if<EmissiveQuadric>(&emitter)) {
        moments_ = quadric->second_moments();
        return;
    }
    const auto& mesh = std::get<EmissiveMesh>(emitter);
    moments_ = mesh_moments(mesh, shape.description.object_to_world.start());
    std::vector<std::array<Vec3, 3>> triangles;
    triangles.reserve(size_t(mesh.light_count()));
    for (int light = 0; light < mesh.light_count(); ++light)
        triangles.push_back(mesh.start_corners(light));
    border_ = BorderEdges(triangles);
}

std::optional<Vec3> EmitterSpectrum::nearest_border(Vec3 position, const Transform& now) const {
    if (const auto* quadric = std::get_if<EmissiveQuadric>(emitter_)) {
        const auto q = quadric->nearest_border(now.inverse().point(position));
        return q ? std::optional(now.point(*q)) : std::nullopt;
    }
    const AnimatedTransform& motion = shape_->description.object_to_world;
    if (!motion.is_animated()) return border_.nearest(position);
    // The border is known where the shape is at the start of the shutter.
    const Vec3 at_start = motion.start().point(now.inverse().point(position));
    const auto q = border_.nearest(at_start);
    return q ? std::optional(now.point(motion.start().inverse().point(*q))) : std::nullopt;
}

SourceSpectrum EmitterSpectrum::at(Vec3 position, Vec3 normal, float time, bool with_border) const {
    const AnimatedTransform& motion = shape_->description.object_to_world;
    std::optional<Transform> moved;
    if (motion.is_animated()) moved = motion.at(time);
    const Transform& now = moved ? *moved : motion.start();
    const Frame tangent = Frame::from_z(normal);
    // The world's moments M S M^T along a tangent x are those of object space, S, along M^T x.
    const auto x = transposed_vector(now, tangent.x), y = transposed_vector(now, tangent.y);
    const auto* quadric = std::get_if<EmissiveQuadric>(emitter_);
    const float curvature = quadric ? quadric->curvature(time) : 0;
    SourceSpectrum s{
        .kind = SourceSpectrum::Kind::area,
        .tangent = tangent,
        .s11 = static_cast<float>(quadratic_form(moments_, x, x)),
        .s12 = static_cast<float>(quadratic_form(moments_, x, y)),
        .s22 = static_cast<float>(quadratic_form(moments_, y, y)),
        .k11 = curvature,
        .k22 = curvature,
        .velocity = motion.is_animated() ? motion.velocity(position, time) : Vec3{},
        .angular_velocity = motion.is_animated() ? motion.angular_velocity(time) : Vec3{}};
    if (!with_border) return s;
    if (const auto border = nearest_border(position, now)) {
        s.border_distance = distance(*border, position);
        const Vec3 towards = s.tangent.to_local(*border - position);
        const Vec2 flat{towards.x, towards.y};
        const float l = length(flat);
        if (l > 0) s.border_direction = flat * (1 / l);
    }
    return s;
}

}  // namespace covtrace
