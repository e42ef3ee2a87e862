#include "occluders/core_bounds.h"

#include <algorithm>
#include <array>

#include "geometry/quadric.h"
#include "occluders/occurrences.h"

namespace covtrace {

namespace {

const std::vector<Vec3>* corners_of(const LocalShape& shape) {
    if (const auto* mesh = std::get_if<TriangleShape>(&shape)) return &mesh->positions;
    if (const auto* patches = std::get_if<PatchShape>(&shape)) return &patches->positions;
    return nullptr;
}

}  // namespace

Bounds3 core_bounds(const Geometry::Impl& geometry) {
    constexpr size_t kSample = 1 << 16;
    const std::vector<Occurrence> all = occurrences(geometry, geometry.clock.open());
    size_t count = 0;
    for (const Occurrence& o : all)
        if (const auto* corners = corners_of(*o.shape)) count += corners->size() - 1;
    const size_t step = count / kSample + 1;
    std::array<std::vector<float>, 3> values;
    size_t next = 0;  // corners to pass before the next one that is sampled
    for (const Occurrence& o : all) {
        const auto add = [&](Vec3 local) {
            const Vec3 p = o.world_from_local.point(Vec3d(local)).to_float();
            if (!is_finite(p)) return;
            for (int axis = 0; axis < 3; ++axis)
                values[static_cast<size_t>(axis)].push_back(p[axis]);
        };
        const auto* corners = corners_of(*o.shape);
        if (!corners) {
            const Bounds3 b = quadric_bounds(std::get<Quadric>(*o.shape));
            add(b.lo);
            add(b.hi);
            continue;
        }
        const size_t size = corners->size() - 1;  // the last corner is a spare one
        for (; next < size; next += step) add((*corners)[next]);
        next -= size;
    }
    Bounds3 core;
    if (values[0].empty()) return core;
    for (int axis = 0; axis < 3; ++axis) {
        auto& v = values[static_cast<size_t>(axis)];
        const auto quantile = [&v](size_t rank) {
            std::nth_element(v.begin(), v.begin() + static_cast<ptrdiff_t>(rank), v.end());
            return v[rank];
        };
        core.lo[axis] = quantile(v.size() / 100);
        core.hi[axis] = quantile(v.size() - 1 - v.size() / 100);
    }
    return core;
}

}  // namespace covtrace
