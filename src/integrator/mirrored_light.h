/// Light that is sampled by flat mirrors (flat_mirrors.h): its density, for the paths that find the
/// same light by themselves (docs/decisions/0133).
#pragma once

#include "integrator/panes.h"

namespace covtrace {

/// A place as a mirror shows it: lights are sampled for it in the place of the real one.
struct MirroredPlace {
    Vec3 position, normal;
    MirroredPlace(const FlatMirror& mirror, const LitPlace& place)
        : position(mirror.reflect_point(place.position)),
          normal(mirror.reflect_direction(place.normal)) {}
};

/// Density per solid angle with which light that leaves a mirror of the scene for the place, and
/// comes to the mirror from the unit direction `to_light`, is sampled there: that of the emitter at
/// `hit`, or of the sky where it is null.
float density_by_mirror(const LitScene& scene, int mirror, const LitPlace& place, Vec3 to_light,
                        const SurfaceHit* hit);

}  // namespace covtrace
