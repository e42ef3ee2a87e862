#include "pbrt/round_meshes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/frame.h"
#include "core/hash.h"

namespace covtrace {

namespace {

constexpr size_t kStepsPerSegment = 5;
/// Normals that are smooth over flat sides lose light, as some of what they scatter goes into the
/// tube. Prisms that are turned at random about their curves send, in their mean, exactly as much
/// light to each direction as round tubes do: hair, whose sides nobody sees, consists of them.
constexpr int kSidesOfPrism = 5, kSidesOfRoundTube = 24;
constexpr float kSlender = 20;  // lengths of a curve by its width from which on it is like hair

bool is_slender(const CurveDescription& curve) {
    float length = 0;
    for (size_t i = 1; i < curve.points.size(); ++i)
        length += distance(curve.points[i - 1], curve.points[i]);
    return length >= kSlender * std::max(curve.width0, curve.width1);
}

/// An angle that differs from curve to curve.
float turn_of(const CurveDescription& curve) {
    uint64_t h = 0;
    for (const Vec3& p : curve.points)
        for (const float c : {p.x, p.y, p.z}) h = hash_combine(h, std::bit_cast<uint32_t>(c));
    return 2 * kPi * to_unit_float(static_cast<uint32_t>(h >> 32));
}

/// Triangles of a grid of vertices, row after row: two for each cell.
std::vector<std::array<uint32_t, 3>> grid_triangles(size_t rows, size_t columns) {
    std::vector<std::array<uint32_t, 3>> all;
    for (size_t r = 0; r + 1 < rows; ++r)
        for (size_t c = 0; c + 1 < columns; ++c) {
            const auto i = static_cast<uint32_t>(r * columns + c),
                       up = static_cast<uint32_t>(columns);
            all.push_back({i, i + 1, i + up + 1});
            all.push_back({i, i + up + 1, i + up});
        }
    return all;
}

struct CurvePoint {
    Vec3 position, derivative;
};

/// Point and derivative of one segment at t, by de Casteljau's or de Boor's scheme on its control
/// points.
CurvePoint evaluate(const CurveDescription& curve, size_t first, float t) {
    const auto degree = static_cast<size_t>(curve.degree);
    std::array<Vec3, 4> p{};
    for (size_t i = 0; i <= degree; ++i) p[i] = curve.points[first + i];
    Vec3 derivative;
    for (size_t level = degree; level > 0; --level) {
        if (level == 1) derivative = p[1] - p[0];
        for (size_t i = 0; i < level; ++i) {
            // Weights depend on the knots: those of a uniform B-spline are 1 apart, those of a
            // Bézier segment coincide at its ends.
            const float span = static_cast<float>(level);
            const float w = curve.is_bspline ? (t + span - 1 - static_cast<float>(i)) / span : t;
            p[i] = lerp(w, p[i], p[i + 1]);
        }
    }
    return {p[0], derivative};
}

/// A place along a curve at which its mesh has vertices.
struct Ring {
    Vec3 position, tangent;  ///< the latter of unit length
    size_t segment;
    float t;  ///< along the segment
    float u;  ///< along the whole curve
    float width;
};

std::vector<Ring> rings_of(const CurveDescription& curve) {
    const size_t segments = curve.segments(), count = segments * kStepsPerSegment + 1;
    const auto degree = static_cast<size_t>(curve.degree);
    std::vector<Ring> rings(count);
    Vec3 tangent{0, 0, 1};
    for (size_t r = 0; r < count; ++r) {
        const size_t segment = std::min(r / kStepsPerSegment, segments - 1);
        const float t = static_cast<float>(r - segment * kStepsPerSegment) / kStepsPerSegment;
        const CurvePoint at = evaluate(curve, curve.is_bspline ? segment : segment * degree, t);
        if (length(at.derivative) > 0) tangent = normalize(at.derivative);
        const float u = static_cast<float>(r) / static_cast<float>(count - 1);
        rings[r] = {at.position, tangent, segment, t, u, (1 - u) * curve.width0 + u * curve.width1};
    }
    return rings;
}

/// Between two unit vectors on the great circle, as pbrt: no more than a right angle apart.
Vec3 turned_between(Vec3 a, Vec3 b, float t) {
    const float angle = std::acos(std::clamp(dot(a, b), 0.0f, 1.0f));
    if (!(angle > 0)) return a;
    return (std::sin((1 - t) * angle) * a + std::sin(t * angle) * b) / std::sin(angle);
}

}  // namespace

TriangleMesh cylinder_mesh(float radius, float z_min, float z_max, float phi_max_degrees,
                           int segments) {
    TriangleMesh m;
    const auto columns = static_cast<size_t>(segments) + 1;
    for (int row = 0; row < 2; ++row)
        for (size_t i = 0; i < columns; ++i) {
            const float u = static_cast<float>(i) / static_cast<float>(segments);
            const float phi = u * phi_max_degrees * kPi / 180;
            m.normals.push_back({std::cos(phi), std::sin(phi), 0});
            const float z = row == 0 ? z_min : z_max;
            m.positions.push_back(radius * m.normals.back() + Vec3{0, 0, z});
            m.uvs.push_back({u, static_cast<float>(row)});
        }
    m.triangles = grid_triangles(2, columns);
    return m;
}

int sides_of(const CurveDescription& curve) {
    return is_slender(curve) ? kSidesOfPrism : kSidesOfRoundTube;
}

TriangleMesh curve_mesh(const CurveDescription& curve) {
    const std::vector<Ring> rings = rings_of(curve);
    const bool is_prism = is_slender(curve);
    const auto sides = static_cast<size_t>(sides_of(curve));
    const float turn = turn_of(curve);
    // The widening makes a tube of flat sides as wide, in the mean over all directions, as a round
    // one.
    const auto corners = static_cast<float>(sides);
    const float widening = kPi / (corners * std::sin(kPi / corners));
    TriangleMesh m;
    Vec3 side;
    for (const Ring& at : rings) {
        // The side turns no more than the tangent makes it, so that the tube doesn't twist.
        side = normalize(side - dot(side, at.tangent) * at.tangent);
        if (!(length(side) > 0.5f)) side = Frame::from_z(at.tangent).x;
        const Vec3 other = cross(at.tangent, side);
        const float radius = 0.5f * widening * at.width;
        for (size_t i = 0; i <= sides; ++i) {
            const float v = static_cast<float>(i) / corners, angle = 2 * kPi * v + turn;
            const Vec3 n = std::cos(angle) * side + std::sin(angle) * other;
            if (!is_prism) m.normals.push_back(n);
            m.positions.push_back(at.position + radius * n);
            m.uvs.push_back({at.u, v});
        }
    }
    m.triangles = grid_triangles(rings.size(), sides + 1);
    return m;
}

TriangleMesh ribbon_mesh(const CurveDescription& curve) {
    const std::vector<Ring> rings = rings_of(curve);
    TriangleMesh m;
    Vec3 across = Frame::from_z(rings.front().tangent).x;
    for (const Ring& at : rings) {
        const Vec3 facing = turned_between(normalize(curve.normals[at.segment]),
                                           normalize(curve.normals[at.segment + 1]), at.t);
        // A normal along the curve says nothing, and the strip goes on as it is.
        const Vec3 upright = cross(at.tangent, facing);
        if (length(upright) > 0) across = normalize(upright);
        for (const float v : {0.0f, 1.0f}) {
            m.positions.push_back(at.position + (v - 0.5f) * at.width * across);
            m.normals.push_back(cross(across, at.tangent));
            m.uvs.push_back({at.u, v});
        }
    }
    m.triangles = grid_triangles(rings.size(), 2);
    return m;
}

}  // namespace covtrace
