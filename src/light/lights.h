/// All lights of a scene: emission, sampling with light selection, and what the frequency analysis
/// asks.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "geometry/geometry.h"
#include "light/environment_map.h"
#include "scene/scene_description.h"
#include "texture/texture.h"

namespace covtrace {

/// A point (or direction) of a light seen from a shading point.
struct LightSample {
    Vec3 wi;  ///< unit, towards the light
    /// To the sampled point; infinite for distant and environment light.
    float distance = kInfinity;
    Rgb radiance;   ///< arriving if unoccluded; for delta lights irradiance of a facing surface
    float pdf = 0;  ///< selection times solid angle; for delta lights selection alone
    bool is_delta = false;
    int light = -1;  ///< id for source_spectrum
    Vec3 position;   ///< of the sampled point where the distance is finite
    Vec3 normal;     ///< of area lights: unit, on the emitting outside
};

/// What the covariance of a light's radiance starts from.
struct SourceSpectrum {
    enum class Kind { area, point, directional, environment };
    Kind kind = Kind::area;
    /// area: at the emitting point, z = normal; all others: x, y span the directions, z is the
    /// direction that the light travels in.
    Frame tangent;
    /// area: second moments of the whole emitter about its centroid in (tangent.x, tangent.y),
    /// length^2
    float s11 = 0, s12 = 0, s22 = 0;
    float k11 = 0, k12 = 0, k22 = 0;  ///< area: shape operator
    Vec3 velocity, angular_velocity;  ///< area
    /// area: from the point to the nearest point of the emitter's border (edges that belong to one
    /// triangle only, the rim of a disk); infinite for closed meshes and for spheres, whose
    /// silhouette depends on the view.
    float border_distance = kInfinity;
    Vec2 border_direction{1, 0};  ///< area: towards it, unit, in (tangent.x, tangent.y)
    /// environment, directional, and point for the image of a goniometric or projection light:
    /// angular covariance in (tangent.x, tangent.y), (cycles per radian)^2
    float a11 = 0, a12 = 0, a22 = 0;
    float cone_variance = 0;  ///< point: angular variance of a spot's cone, 0 for none
};

/// An emissive shape as a whole, at a distance.
struct DistantView {
    Bounds3 box;          ///< over the shutter
    float intensity = 0;  ///< bound on the luminance of its radiant intensity in any direction
    float radiance = 0;   ///< luminance, mean over the shape
};

class Lights {
  public:
    /// Image files that are missing, broken or of an unknown layout throw Error(scene) with the
    /// place in the scene file. `geometry` and `textures` must outlive the lights; without textures
    /// there is no alpha and no image on area lights. Shapes of instanced objects don't emit.
    Lights(const SceneDescription& scene, const Geometry& geometry,
           const TextureStore* textures = nullptr);
    ~Lights();
    Lights(const Lights&) = delete;
    Lights& operator=(const Lights&) = delete;

    /// Chooses a light for the point p, then a point on it. Empty where the chosen light can't
    /// light p. `u_select` chooses the light. `n` is the unit normal on the side that light is
    /// wanted for: for opaque surfaces the side of the viewer; the zero vector for volumes and
    /// where light counts from both sides. Light from behind n is found seldom, beside
    /// infinite light not at all, and uniform infinite light only above n. Not all light is found:
    /// what comes from all directions alike is left to BSDFs and phase functions where other lights
    /// outshine it, and so is the dark part of environment maps.
    ///
    /// All infinite lights with extent count as one here: `radiance` and `pdf` are of all of them
    /// together.
    std::optional<LightSample> sample(Vec3 p, Vec3 n, float time, float u_select, Vec2 u) const {
        return finish_draw(p, n, time, u_select, {u, {}, 0});
    }

    /// What of a sample depends on `u` alone: where it falls in an environment map. Begun as soon
    /// as u is known, it lets memory answer while a path looks for p.
    struct Draw {
        Vec2 u;
        EnvironmentMap::Draw sky;
        int steps = 0;  ///< of it that are done
    };
    /// Whether there is anything to gain: one infinite light with an image, and no other.
    bool draws_ahead() const;
    /// The first step.
    Draw begin_draw(Vec2 u) const;
    /// The second one, best before something else that takes its time.
    void continue_draw(Draw& draw) const;
    /// `sample` with a draw that was taken as far as time allowed.
    std::optional<LightSample> finish_draw(Vec3 p, Vec3 n, float time, float u_select,
                                           Draw draw) const;

    /// Radiance that the surface at `hit` emits towards `wo` (unit, away from the surface).
    Rgb emitted(const SurfaceHit& hit, Vec3 wo) const;
    /// Density with which `sample(p, n)` finds the emitter point `hit` in the direction wi:
    /// selection times solid angle.
    float pdf(Vec3 p, Vec3 n, Vec3 wi, const SurfaceHit& hit) const;

    bool has_environment() const;
    /// Radiance of all infinite lights from the direction `w` (unit, away from the scene).
    Rgb environment(Vec3 w) const;
    /// What comes from a direction of the infinite lights, and the density with which `sample(p,
    /// n)` finds it there.
    struct Sky {
        Rgb radiance;
        float pdf = 0;
    };
    Sky sky(Vec3 p, Vec3 n, Vec3 w) const;
    float environment_pdf(Vec3 p, Vec3 n, Vec3 w) const { return sky(p, n, w).pdf; }

    /// Computes what the source spectra need; to be called once before asking for any. Not
    /// thread-safe.
    void prepare_spectra();
    /// Of an emitter that lights something. Without its border, which only one in view shows.
    SourceSpectrum source_spectrum(const LightSample& s, float time) const;
    /// Of the shape that was hit; empty where it does not emit. The border is left infinitely far
    /// unless it is asked for: finding it takes a search.
    SourceSpectrum source_spectrum(const SurfaceHit& emitter, bool with_border) const;
    /// Whether the infinite lights shine alike from all directions, with a spectrum that is zero.
    bool has_even_sky() const;
    /// Of all infinite lights together around the direction `w`, weighted by radiance.
    SourceSpectrum environment_spectrum(Vec3 w) const;

    /// The emissive shapes that rays can meet.
    std::vector<DistantView> distant_views() const;

    /// Power that all lights emit, of infinite ones that which enters the sphere around the scene.
    Rgb total_power() const;
    /// Every emissive triangle, patch half, sphere and disk counts as a light of its own.
    int count() const;
    /// That the colour space of an image is not known.
    const Warnings& warnings() const;
    /// Probability that `sample(p, n)` chooses the light. Those of all lights sum to 1, or less
    /// where all of a group of lights look away from p: choosing the group then chooses none.
    float selection_probability(Vec3 p, Vec3 n, int light) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace covtrace
