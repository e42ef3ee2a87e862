/// Triangles in place of any local shape, with bounded error, for uses that need no exact surface.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "geometry/surface.h"

namespace covtrace {

/// Whether `shape` has triangles of its own, or parallelograms that are two of them each.
bool is_flat(const LocalShape& shape);

/// Triangles over positions; either list may belong to the shape itself, which must outlive this.
class Tessellation {
  public:
    using Opacity = std::function<float(const SurfacePoint& local)>;

    /// Cuts curved shapes into pieces of about `piece` scene units, at most 512 along a parameter;
    /// `scale` is how much longer a local unit may be in the scene.
    Tessellation(const LocalShape& shape, double piece, double scale);

    /// Makes a surface with holes: the shape is cut into pieces of about `piece` everywhere, at
    /// most 64 along a primitive's edge. Pieces that `opacity` makes opaque are kept, and a part of
    /// those that are partly so. `opacity` gets a point in local space.
    Tessellation(const LocalShape& shape, double piece, double scale, const Opacity& opacity);

    size_t size() const { return triangles().size(); }
    std::array<Vec3, 3> operator[](size_t i) const {
        const auto& t = triangles()[i];
        const auto& p = positions();
        return {p[t[0]], p[t[1]], p[t[2]]};
    }
    const std::vector<Vec3>& positions() const { return mesh_ ? mesh_->positions : positions_; }
    const std::vector<std::array<uint32_t, 3>>& triangles() const {
        return mesh_ ? mesh_->mesh->triangles : triangles_;
    }
    /// Bytes of its own, without what belongs to the shape.
    size_t memory() const {
        return positions_.capacity() * sizeof(Vec3) +
               triangles_.capacity() * sizeof(std::array<uint32_t, 3>);
    }

  private:
    template <class PointAt>
    void add_grid(int nu, int nv, PointAt&& point_at);
    template <class PointAt>
    void add_opaque(int nu, int nv, bool is_triangle, PointAt&& point_at, const Opacity& opacity);

    uint64_t considered_ = 0;  ///< pieces that were looked at, for a shape with holes
    const TriangleShape* mesh_ = nullptr;
    std::vector<Vec3> positions_;
    std::vector<std::array<uint32_t, 3>> triangles_;
};

}  // namespace covtrace
