/// Embree instances of a scene, still or moving. Only for .cpp files of this folder.
#pragma once

#include "geometry/embree_device.h"
#include "geometry/motion.h"

namespace covtrace {

GeometryHandle new_still_instance(const EmbreeDevice& device, RTCScene scene, const Transform& map);

/// Makes a moving instance, with as many keys as it takes (at most 129) for Embree's interpolation
/// to keep within 1e-5 of the extent of `scene` of where `motion` puts it. Rigid motions and those
/// that keep their stretch take few; where a stretch of 10 to 1 is turned by 90 degrees, 129 leave
/// 3e-5, by 170 1e-4.
GeometryHandle new_moving_instance(const EmbreeDevice& device, RTCScene scene, const Motion& motion,
                                   const ShutterClock& clock);

/// The map that Embree uses at a parameter of the clock, from the instanced scene to the world.
Affine instance_transform(RTCGeometry instance, float parameter);

}  // namespace covtrace
