/// Bump and normal maps, and turned tangents: the shading frame that they give a surface, and how
/// fast it turns.
///
/// In pbrt-v4, and so here, a displacement d along the shading normal n turns the tangents into
///
///   dp'/du = dp/du + (dd/du) n + d dn/du,   dp'/dv = dp/dv + (dd/dv) n + d dn/dv,
///
/// whose cross product is the new normal; a normal map holds the new normal in the frame of n and
/// dp/du. A strength s other than 1 makes it normalize(s m + (1 - s) n) of the new normal m, as
/// Cycles' node Bump does (svm/displace.h, svm_node_set_bump). Tangents that a mesh has of its own
/// stand for dp/du here. Derivatives of d are differences over a fraction of a pixel. The surface
/// itself stays.
#pragma once

#include "core/frame.h"
#include "geometry/geometry.h"
#include "texture/texture.h"

namespace covtrace {

/// The layer of a material that a map belongs to: a clear coat has a normal map of its own.
enum class MappedLayer { surface, clearcoat };

/// A material's map at a point of a surface. All references must outlive the object.
class NormalMap {
  public:
    /// Prepares a map. `base`: geometry of the unmapped surface at `hit`. `footprint`: distance
    /// over which differences are taken, scene units, > 0.
    NormalMap(const MaterialDescription& material, const TextureStore& textures,
              const PlacedShape& shape, const SurfaceHit& hit, const DifferentialGeometry& base,
              float footprint, MappedLayer layer = MappedLayer::surface);

    /// The mapped frame. z: the new shading normal, in the hemisphere of hit.ng; x along the new
    /// dp/du, turned as the material says.
    Frame frame() const;
    /// Shape operator that the map adds to the base's, in (t1, t2) that span its tangent plane:
    /// k11, k12, k22, 1 / scene unit.
    std::array<float, 3> curvature() const;

  private:
    Frame frame_at(Vec2 shift) const;
    float height(Vec2 shift) const;

    const MaterialDescription& material_;
    TextureId normal_map_, displacement_;
    float normal_scale_;
    const TextureStore& textures_;
    const SurfaceHit& hit_;
    const DifferentialGeometry& base_;
    Vec3 dpdu_, dpdv_, dndu_, dndv_;  // of the shading geometry
    Vec2 step_;                       // in (u, v)
    float y_sign_ = 1;                // of the map's y in the shading frame
};

}  // namespace covtrace
