/// Local shapes as Embree geometries. Only for .cpp files of this folder.
#pragma once

#include "geometry/embree_device.h"
#include "geometry/surface.h"

namespace covtrace {

/// Ray masks: interface surfaces are seen by `intersect` and not by `occluded`.
inline constexpr unsigned kSolidMask = 1, kInterfaceMask = 2, kEveryMask = 3;

/// A committed geometry that refers to `shape`, which must stay where it is; null where the shape
/// has no primitives.
GeometryHandle new_shape_geometry(const EmbreeDevice& device, const LocalShape& shape,
                                  bool is_interface);

}  // namespace covtrace
