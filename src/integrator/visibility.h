/// What of a light's radiance reaches a point: occlusion by surfaces, extinction by media.
#pragma once

#include "integrator/lit_scene.h"

namespace covtrace {

/// The medium that a ray is in after it leaves `hit` in the direction `w`; `current` before.
MediumId medium_beyond(const PlacedShape& shape, const SurfaceHit& hit, Vec3 w, MediumId current);

/// Transmittance over a piece of a medium; infinite lengths count as the scene's
/// `unbounded_distance`.
Rgb transmittance(const LitScene& scene, MediumId medium, float distance);

/// Share of light per channel that comes along `ray` from `distance` away (infinite for lights
/// without a place), `medium` being around the ray's origin. `ray.t_max` ends just short of the
/// light; surfaces before it take all light, interfaces let it pass into the next medium. Adds
/// the rays that it traces to `rays`.
Rgb visibility(const LitScene& scene, Ray ray, float distance, MediumId medium, uint32_t& rays);

/// More interfaces than this end a path or a look at a light: the ray is caught between coincident
/// ones.
inline constexpr int kMostInterfaces = 1000;

}  // namespace covtrace
