/// Directions of area lights: what their cones and images leave.
#pragma once

#include "light/lights_impl.h"

namespace covtrace {

/// Sets what a description says of the directions of a light, and its soft falloff. Throws as
/// LightImage::goniometric; warns of soft falloff where the shape can't have it.
void direct(AreaLight& area, const AreaLightDescription& light, const ShapeDescription& shape,
            Warnings& warnings);
/// Leaves of a light's directions those within its cone.
void narrow(LightBounds& bounds, const AreaLight& area);
/// Mean of a light's image over its directions within its cone; 1 without an image.
Rgb mean_over_directions(const AreaLight& area);
/// Share of a light's power that its cone and the image leave; images may hold more than 1. Exact
/// for cones of spheres and of what is flat; else the shape is taken to shine to all sides alike.
Rgb share_let_through(const AreaLight& area);

}  // namespace covtrace
