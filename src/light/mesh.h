/// Triangle meshes and bilinear patches as emitters: each triangle, and each half of a patch, is a
/// light of its own.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/geometry.h"
#include "light/emitter.h"

namespace covtrace {

class EmissiveMesh {
  public:
    /// Makes emitters of a shape's mesh; `geometry` must outlive them.
    EmissiveMesh(const Geometry& geometry, uint32_t shape);

    int light_count() const { return static_cast<int>(elements_.size()); }
    /// The light of this mesh that a hit of its shape lies on.
    int light_of(const SurfaceHit& hit) const;
    /// A point on a light. Flat elements: uniform by solid angle as seen from p, but by area where
    /// the solid angle is tiny or nearly a hemisphere. Halves of patches that are no
    /// parallelograms: uniform over the patch's (u, v). Empty where the density is not finite.
    std::optional<EmitterPoint> sample(int light, Vec3 p, float time, Vec2 u) const;
    /// Density of `sample` at a hit, per solid angle.
    float pdf(int light, Vec3 p, const SurfaceHit& hit) const;
    /// The surface's texture coordinates at a sampled point, which are the same at any time.
    Vec2 uv(int light, const EmitterPoint& point, float time) const;
    /// The place of a sampled point in a mesh whose vertices have values.
    VertexPlace vertices(int light, const EmitterPoint& point) const;
    /// The unit normal of shading at a sampled point, on either side.
    Vec3 shading_normal(int light, const EmitterPoint& point, float time) const;
    /// Area of a light in world space, at the start of the shutter.
    float area(int light) const;
    /// Bounds of a light over the shutter, with the largest intensity that a radiance of 1 gives at
    /// its start: the area.
    LightBounds bounds(int light) const;

    /// Corners of a light in world space at the start of the shutter.
    std::array<Vec3, 3> start_corners(int light) const;
    bool is_patches() const { return is_patches_; }

  private:
    /// One triangle or half of a patch: the points p0 + b1 (p1 - p0) + b2 (p2 - p0) + b1 b2 twist
    /// with b1, b2 >= 0 and b1 + b2 <= 1. In world space where nothing moves, else in object space.
    struct Element {
        Vec3 p0, p1, p2;
        Vec3 normal;  // unit, along d1 x d2 at p0: for flat elements everywhere
        Vec3 twist;   // zero for flat elements
        // One value per corner; interpolated at a point, the sign tells whether d1 x d2 points to
        // the outside there.
        Vec3 facing;
        Vec3 left_out;  // of flat elements: a twist that is roundings alone
        bool is_flat() const { return twist == Vec3{}; }
        /// Derivatives of the point by b1 and b2.
        Vec3 d1(Vec2 b) const { return p1 - p0 + twist * b.y; }
        Vec3 d2(Vec2 b) const { return p2 - p0 + twist * b.x; }
        Vec3 point(Vec2 b) const {
            return p0 + (p1 - p0) * b.x + (p2 - p0) * b.y + twist * (b.x * b.y);
        }
        Vec3d unrounded_point(Vec2 b) const {
            const Vec3d p(p0);
            return p + (Vec3d(p1) - p) * double(b.x) + (Vec3d(p2) - p) * double(b.y) +
                   Vec3d(twist) * (double(b.x) * double(b.y));
        }
    };
    /// The element of a light in world space.
    Element at(int light, float time) const;
    static Element moved(Element e, const Affine& map);
    /// Sets the unrounded place of a point that is sampled for p, and its error. `own`: the element
    /// as it is kept; `e`: in world space; `map`: from one to the other, where it moves.
    void find_place(const Element& own, const Element& e, const std::optional<Affine>& map, Vec3 p,
                    Vec2 b, EmitterPoint& point) const;
    /// Density per solid angle, seen from p, of the point `position` = e.point(b) where b is drawn
    /// uniformly; 0 where it is not finite.
    static float area_pdf(const Element& e, Vec3 p, Vec3 position, Vec2 b);

    decltype(ShapeDescription::geometry) mesh_;
    std::vector<Element> elements_;
    bool is_patches_ = false;
    const Geometry* geometry_;
    uint32_t shape_;
    const AnimatedTransform* motion_ = nullptr;  // null where nothing moves
    bool moves_ = false;                         // whether it moves while the shutter is open
};

}  // namespace covtrace
