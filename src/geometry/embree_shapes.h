/// Local shapes as Embree geometries. Only for .cpp files of this folder.
#pragma once

#include "geometry/embree_device.h"
#include "geometry/surface.h"

namespace covtrace {

/// Ray masks by the kind of surface. Interface surfaces are seen by `intersect` and not by
/// `occluded`; surfaces with alpha are solid where they are opaque.
inline constexpr unsigned kSolidMask = 1, kInterfaceMask = 2, kAlphaMask = 4, kEveryMask = 7;

/// A committed geometry that refers to `shape`, which must stay where it is; null where the shape
/// has no primitives. `mask`: one of the masks above.
GeometryHandle new_shape_geometry(const EmbreeDevice& device, const LocalShape& shape,
                                  unsigned mask);

/// Whether Embree has an intersection of its own for a shape: it calls ours for the others.
bool is_intersected_by_embree(const LocalShape& shape);

}  // namespace covtrace
