/// From a point on a surface to the coordinates (s, t) of a texture, and how fast these change.
#pragma once

#include "core/vec.h"
#include "scene/scene_description.h"
#include "texture/image.h"
#include "texture/texture.h"

namespace covtrace {

/// Texture coordinates as pbrt-v4 defines them: spherical (theta / pi, phi / 2 pi), cylindrical
/// ((pi + phi) / 2 pi, z), planar (delta_u + p.v1, delta_v + p.v2) with p in texture space.
Vec2 map_to_st(const TextureMapping& mapping, const TexturePoint& at);

/// Derivatives of two texture coordinates by the surface's (u, v).
struct StGradient {
    Vec2 s;  ///< (ds/du, ds/dv)
    Vec2 t;  ///< (dt/du, dt/dv)
};
/// Exact derivatives of `map_to_st` by (u, v) where p moves by dpdu du + dpdv dv; zero where the
/// mapping has none (the origin of a spherical mapping, the axis of a cylindrical one).
StGradient st_gradient(const TextureMapping& mapping, const TexturePoint& at, Vec3 dpdu, Vec3 dpdv);

/// The ellipse in (s, t) that the footprint of `at` covers.
ImageFootprint image_footprint(const TextureMapping& mapping, const TexturePoint& at);

}  // namespace covtrace
