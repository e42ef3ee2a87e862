/// The surface that a camera ray meets first, for the layers that tell of it.
#pragma once

#include <array>

#include "integrator/path.h"

namespace covtrace {

/// The first vertex of a path, in the space of FilmDescription::Surfaces. 52 bytes.
struct FirstSurface {
    Vec3 position;
    Vec3 geometric_normal, normal;  ///< unit, towards the viewer; 0 in media
    Vec2 uv;
    /// Change of the position's z from one pixel to the next, to the right and down, on the tangent
    /// plane.
    Vec2 slope;

    /// Moves every number by `share` of the way towards that of `other`: steps of a running mean.
    void approach(const FirstSurface& other, float share);
};

/// The surface that a path met first. `ray`: its camera ray; `beside`: those of the same place on
/// the lens and in the shutter a pixel to the right and a pixel below. Numbers that are not finite
/// become 0.
FirstSurface first_surface(const RenderScene& scene, FilmDescription::Surfaces space,
                           const Ray& ray, const std::array<Ray, 2>& beside,
                           const PathResult& path);

}  // namespace covtrace
