/// Visibility: the part of a light's radiance that reaches a point, after occlusion by surfaces and
/// extinction by media.
#pragma once

#include "integrator/lit_scene.h"

namespace covtrace {

/// Whether `hit` is the back of a surface that is seen from its front alone. Rays in `direction` by
/// which the camera sees pass it; light meets it all the same.
inline bool is_unseen_back(const PlacedShape& shape, const SurfaceHit& hit, Vec3 direction) {
    return !shape.description.is_seen_from_back && dot(direction, hit.ng) > 0;
}

/// The medium that a ray is in after it leaves `hit` in the direction `w`; before, it was in
/// `current`.
MediumId medium_beyond(const PlacedShape& shape, const SurfaceHit& hit, Vec3 w, MediumId current);

/// The factor on light that comes through the surface at a hit unscattered; 0 where none does.
float passed_share(const LitScene& scene, const SurfaceHit& hit);

/// Transmittance over a piece of a ray in a medium; infinite lengths count as the scene's
/// `unbounded_distance`.
Rgb transmittance(const LitScene& scene, MediumId medium, const Ray& ray, float distance);

/// Aims a ray at a point from where it starts, to end just short of it; the point is to be clear of
/// its surface. Returns the distance; 0: there is no way to go.
float aim(Ray& ray, Vec3 target);
/// Aims a ray at a sampled light from where it starts. Returns the distance, infinite for light
/// without a place; 0: there is no way to go.
float aim(Ray& ray, const LightSample& light);

/// Share of light per channel that comes along `ray` from `distance` away (infinite for lights
/// without a place), `medium` being around the ray's origin. `ray.t_max` ends just short of the
/// light, and Geometry::occluded has found nothing before it; interfaces let light pass into the
/// next medium, other surfaces take all of it. The rays that are traced are added to `rays`.
Rgb visibility(const LitScene& scene, Ray ray, float distance, MediumId medium, uint64_t& rays);

/// Whether anything in (0, ray.t_max) hides a sampled light: light that comes through panes is
/// found where it is sampled through them.
inline bool is_hidden(const LitScene& scene, const Ray& ray) {
    return scene.samples_through_panes ? scene.geometry.blocked(ray) : scene.geometry.occluded(ray);
}

/// Whether a ray of its kind meets a surface in (0, ray.t_max); interfaces and emitters that let
/// light pass are none. The rays that are traced are added to `rays`.
bool is_met(const LitScene& scene, Ray ray, uint64_t& rays);

/// Most interfaces on a path or on the way to a light: beyond them the ray is caught between
/// coincident ones.
inline constexpr int kMostInterfaces = 1000;

}  // namespace covtrace
