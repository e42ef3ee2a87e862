#include "geometry/tessellation.h"

#include <algorithm>
#include <cmath>

#include "core/hash.h"
#include "geometry/quadric.h"

namespace covtrace {

namespace {
int pieces(double length, double piece, int least) {
    return static_cast<int>(std::clamp(std::ceil(length / piece), double(least), 512.0));
}
}  // namespace

bool is_flat(const LocalShape& shape) {
    const auto* patches = std::get_if<PatchShape>(&shape);
    return std::holds_alternative<TriangleShape>(shape) || (patches && patches->parallelograms);
}

Tessellation::Tessellation(const LocalShape& shape, double piece, double scale) {
    if ((mesh_ = std::get_if<TriangleShape>(&shape))) return;
    if (const auto* patches = std::get_if<PatchShape>(&shape)) {
        for (uint32_t i = 0; i < patches->mesh->patches.size(); ++i) {
            const BilinearPatch p = patches->patch(i);
            const auto count = [&](Vec3d edge_a, Vec3d edge_b) {
                return patches->parallelograms
                           ? 1
                           : pieces(scale * std::max(length(edge_a), length(edge_b)), piece, 1);
            };
            add_grid(count(p.du(0), p.du(1)), count(p.dv(0), p.dv(1)),
                     [&p](double u, double v) { return p.point(u, v).to_float(); });
        }
        return;
    }
    const Quadric& quadric = std::get<Quadric>(shape);
    const Affine& map = quadric.local_from_object;
    const double radius = quadric.radius * scale *
                          std::max({length(map.row[0]), length(map.row[1]), length(map.row[2])});
    const int around = pieces(quadric.phi_max * radius, piece, 16);
    const int along = quadric.kind == Quadric::Kind::sphere ? pieces(3.2 * radius, piece, 8) : 1;
    add_grid(around, along, [&](double u, double v) {
        return map.point(quadric_object_point(quadric, u, v)).to_float();
    });
}

Tessellation::Tessellation(const LocalShape& shape, double piece, double scale,
                           const Opacity& opacity) {
    // The number of pieces is bounded: small pieces of large triangles would outgrow memory, and
    // holes of a 64th of a triangle do.
    constexpr int kMost = 64;
    const auto count = [&](double edge) { return std::min(kMost, pieces(scale * edge, piece, 1)); };
    if (const auto* mesh = std::get_if<TriangleShape>(&shape)) {
        for (uint32_t i = 0; i < mesh->mesh->triangles.size(); ++i) {
            const auto& t = mesh->mesh->triangles[i];
            const Vec3d p0(mesh->positions[t[0]]), p1(mesh->positions[t[1]]),
                p2(mesh->positions[t[2]]);
            const int n = count(std::max({length(p1 - p0), length(p2 - p0), length(p2 - p1)}));
            add_opaque(
                n, n, true, [&](Vec2 b) { return triangle_point(*mesh, i, b); }, opacity);
        }
    } else if (const auto* patches = std::get_if<PatchShape>(&shape)) {
        for (uint32_t i = 0; i < patches->mesh->patches.size(); ++i) {
            const BilinearPatch p = patches->patch(i);
            add_opaque(
                count(std::max(length(p.du(0)), length(p.du(1)))),
                count(std::max(length(p.dv(0)), length(p.dv(1)))), false,
                [&](Vec2 uv) { return patch_point(*patches, i, uv); }, opacity);
        }
    } else {
        const Quadric& quadric = std::get<Quadric>(shape);
        const Affine& map = quadric.local_from_object;
        const double radius =
            quadric.radius * std::max({length(map.row[0]), length(map.row[1]), length(map.row[2])});
        add_opaque(
            std::max(16, count(quadric.phi_max * radius)), std::max(8, count(3.2 * radius)), false,
            [&](Vec2 uv) {
                return quadric_point(quadric, map.point(quadric_object_point(quadric, uv.x, uv.y)));
            },
            opacity);
    }
}

template <class PointAt>
void Tessellation::add_opaque(int nu, int nv, bool is_triangle, PointAt&& point_at,
                              const Opacity& opacity) {
    const auto at = [&](int i, int j) { return Vec2{float(i) / float(nu), float(j) / float(nv)}; };
    const auto consider = [&](Vec2 a, Vec2 b, Vec2 c) {
        const SurfacePoint centre = point_at((a + b + c) * (1.0f / 3));
        const float chance = to_unit_float(static_cast<uint32_t>(mix_bits(++considered_) >> 32));
        if (!(opacity(centre) > chance)) return;
        const auto first = static_cast<uint32_t>(positions_.size());
        for (const Vec2 corner : {a, b, c})
            positions_.push_back(point_at(corner).position.to_float());
        triangles_.push_back({first, first + 1, first + 2});
    };
    for (int j = 0; j < nv; ++j)
        for (int i = 0; i < (is_triangle ? nu - j : nu); ++i) {
            consider(at(i, j), at(i + 1, j), at(i, j + 1));
            if (!is_triangle || i + j + 1 < nu)
                consider(at(i + 1, j + 1), at(i, j + 1), at(i + 1, j));
        }
}

template <class PointAt>
void Tessellation::add_grid(int nu, int nv, PointAt&& point_at) {
    const auto first = static_cast<uint32_t>(positions_.size());
    for (int j = 0; j <= nv; ++j)
        for (int i = 0; i <= nu; ++i)
            positions_.push_back(point_at(double(i) / nu, double(j) / nv));
    const auto index = [&](int i, int j) {
        return first + static_cast<uint32_t>(j * (nu + 1) + i);
    };
    for (int j = 0; j < nv; ++j)
        for (int i = 0; i < nu; ++i) {
            triangles_.push_back({index(i, j), index(i + 1, j), index(i, j + 1)});
            triangles_.push_back({index(i + 1, j + 1), index(i, j + 1), index(i + 1, j)});
        }
}

}  // namespace covtrace
