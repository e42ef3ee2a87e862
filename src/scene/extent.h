/// Where the shapes of a scene lie.
#pragma once

#include <functional>

#include "scene/scene_description.h"

namespace covtrace {

/// Calls `visit` with points in world space whose convex hull holds all shapes and instances as
/// they stand when the shutter opens, displacements aside: the vertices of meshes, and the corners
/// of boxes around spheres and disks. Meshes that follow after a few million vertices have their
/// boxes' corners, too, so that many instances of large ones take no time. Numbers that are not
/// finite are left out. Of a frame of an animation, only the corners of SceneDescription::swept.
void visit_points(const SceneDescription& scene, const std::function<void(Vec3)>& visit);

/// The box around all that `visit_points` finds; empty where that is nothing.
Bounds3 bounds(const SceneDescription& scene);

}  // namespace covtrace
