#include "geometry/tessellation.h"

#include <algorithm>
#include <cmath>

#include "geometry/quadric.h"

namespace covtrace {

namespace {
int pieces(double length, double piece, int least) {
    return static_cast<int>(std::clamp(std::ceil(length / piece), double(least), 512.0));
}
}  // namespace

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
