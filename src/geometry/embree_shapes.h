/// Local shapes as Embree geometries. Only for .cpp files of this folder.
#pragma once

#include "geometry/embree_device.h"
#include "geometry/surface.h"

namespace covtrace {

/// Ray masks: a bit for each kind of ray, for `intersect`, two for `occluded`, which sees no
/// interfaces, and surfaces with alpha where they are opaque, and two for what is behind panes: for
/// `blocked`, what is solid and mixes, and for `intersect_behind_panes`, all scattered rays see.
constexpr unsigned ray_mask(RayKind kind) {
    return set_of(kind);
}
inline constexpr unsigned kSolidMask = 0x80, kAlphaMask = 0x100, kBlockingMask = 0x200,
                          kBehindPanesMask = 0x400, kEveryMask = 0x7ff;

/// A committed geometry that refers to `shape`, which must stay where it is; null where the shape
/// has no primitives. `mask`: the rays that see it, of the masks above.
GeometryHandle new_shape_geometry(const EmbreeDevice& device, const LocalShape& shape,
                                  unsigned mask);

/// Whether Embree has an intersection of its own for a shape: it calls ours for the others.
bool is_intersected_by_embree(const LocalShape& shape);

}  // namespace covtrace
