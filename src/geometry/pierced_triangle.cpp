#include "geometry/pierced_triangle.h"

namespace covtrace {

SurfacePoint PiercedTriangle::point(float i, float j, float n) const {
    if (const auto* mesh = std::get_if<TriangleShape>(&shape_))
        return triangle_point(*mesh, triangle_, {i / n, j / n});
    // The second triangle of a patch starts at its far corner.
    const bool is_second = triangle_ % 2 == 1;
    const Vec2 uv = is_second ? Vec2{(n - i) / n, (n - j) / n} : Vec2{i / n, j / n};
    return patch_point(std::get<PatchShape>(shape_), triangle_ / 2, uv);
}

std::vector<PiercedTriangle::Piece> PiercedTriangle::pieces(int per_edge,
                                                            const IsOpaque& is_opaque) const {
    const auto n = static_cast<float>(per_edge);
    std::vector<std::vector<Vec3>> grid(static_cast<size_t>(per_edge) + 1);
    for (int j = 0; j <= per_edge; ++j)
        for (int i = 0; i + j <= per_edge; ++i)
            grid[size_t(j)].push_back(point(float(i), float(j), n).position.to_float());

    std::vector<Piece> kept;
    const auto is_kept = [&](int i, int j, float third) {
        return is_opaque(point(float(i) + third, float(j) + third, n));
    };
    for (int j = 0; j < per_edge; ++j)
        for (int i = 0; i + j < per_edge; ++i) {
            const auto a = static_cast<size_t>(i), b = static_cast<size_t>(j);
            const Vec3 right = grid[b][a + 1], up = grid[b + 1][a];
            if (is_kept(i, j, 1.0f / 3))
                kept.push_back({{grid[b][a], right, up},
                                {j == 0 ? 0 : kInside, i + j + 1 == per_edge ? 1 : kInside,
                                 i == 0 ? 2 : kInside}});
            if (i + j + 1 < per_edge && is_kept(i, j, 2.0f / 3))
                kept.push_back({{grid[b + 1][a + 1], up, right}, {kInside, kInside, kInside}});
        }
    return kept;
}

}  // namespace covtrace
