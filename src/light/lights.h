/// All lights of a scene: emission, and sampling with light selection.
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
    /// Distance to the sampled point; infinite for distant and environment light.
    float distance = kInfinity;
    Rgb radiance;   ///< arriving if unoccluded; for delta lights irradiance of a facing surface
    float pdf = 0;  ///< selection times solid angle; for delta lights selection alone
    bool is_delta = false;
    int light = -1;  ///< id for LightSpectra::source_spectrum
    Vec3 position;   ///< of the sampled point where the distance is finite
    Vec3 normal;     ///< of area lights: unit, on the emitting outside
};

/// An emissive shape as a whole, at a distance.
struct DistantView {
    Bounds3 box;          ///< over the shutter
    float intensity = 0;  ///< bound on the luminance of its radiant intensity in any direction
    float radiance = 0;   ///< luminance, mean over the shape
};

class Lights {
  public:
    /// Builds the lights of a scene. Image files that are missing, broken or of an unknown layout
    /// throw Error(scene) with the place in the scene file. `geometry` and `textures` must outlive
    /// the lights; without textures there is no alpha and no image on area lights. Shapes of
    /// instanced objects don't emit.
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
    /// Infinite lights with extent count as one light here: `radiance` and `pdf` are of all of them
    /// together.
    std::optional<LightSample> sample(Vec3 p, Vec3 n, float time, float u_select, Vec2 u) const {
        return finish_draw(p, n, time, u_select, {u, {}, 0});
    }

    /// The part of a sample that depends on `u` alone: the place where it falls in an environment
    /// map. Begun as soon as u is known, it lets memory answer while a path looks for p.
    struct Draw {
        Vec2 u;
        EnvironmentMap::Draw sky;
        int steps = 0;  ///< steps of the draw that are done
    };
    /// Whether drawing ahead gains anything: the scene has one infinite light with an image, and no
    /// other light.
    bool draws_ahead() const;
    /// Does the first step of a draw.
    Draw begin_draw(Vec2 u) const;
    /// Does the second step of a draw, best before something else that takes its time.
    void continue_draw(Draw& draw) const;
    /// Finishes `sample` with a draw that was taken as far as time allowed.
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
    /// Radiance of the infinite lights from one direction, and the density with which `sample(p,
    /// n)` finds that direction.
    struct Sky {
        Rgb radiance;
        float pdf = 0;
    };
    Sky sky(Vec3 p, Vec3 n, Vec3 w) const;
    float environment_pdf(Vec3 p, Vec3 n, Vec3 w) const { return sky(p, n, w).pdf; }

    /// All emissive shapes that rays can meet, each as a whole.
    std::vector<DistantView> distant_views() const;

    /// Power that all lights emit; infinite lights count with what enters the sphere around the
    /// scene.
    Rgb total_power() const;
    /// Number of lights: every emissive triangle, patch half, sphere and disk counts as one of its
    /// own.
    int count() const;
    /// Warnings of images whose colour space is not known.
    const Warnings& warnings() const;
    /// Probability that `sample(p, n)` chooses the light. Over all lights it sums to 1, or to less
    /// where a whole group of lights looks away from p: choosing the group then chooses none.
    float selection_probability(Vec3 p, Vec3 n, int light) const;

  private:
    friend class LightSpectra;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace covtrace
