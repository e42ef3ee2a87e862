/// All lights of a scene: emission, and sampling with light selection.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/geometry.h"
#include "light/environment_map.h"
#include "light/image.h"
#include "light/sky_cell.h"
#include "light/spot_cone.h"
#include "light/tree.h"
#include "scene/scene_description.h"
#include "texture/texture.h"

namespace covtrace {

/// A point (or direction) of a light seen from a shading point.
struct LightSample {
    Vec3 wi;  ///< unit, towards the light
    /// Distance to the sampled point; infinite for distant and environment light.
    float distance = kInfinity;
    Rgb radiance;  ///< arriving if unoccluded; for delta lights irradiance of a facing surface
    /// Density per solid angle, with the probability of choosing the light; for delta lights that
    /// probability alone.
    float pdf = 0;
    bool is_delta = false;
    int light = -1;  ///< id for LightSpectra::source_spectrum
    Vec3 position;   ///< where rays from the shading point end, clear of the light's own surface
    Vec3 normal;     ///< of area lights: unit, on the emitting outside
    /// Whether `radiance` and `pdf` are still to be had, by Lights::sky for `wi`: the image's
    /// memory was asked for, and does not answer at once.
    bool is_to_be_looked_at = false;
    /// Scattered rays that find the light. Others do not carry it, whether they hit the light or
    /// it is sampled for them.
    RayKinds visible_to = kEveryRay;
};

/// An emissive shape as a whole, at a distance.
struct DistantView {
    Bounds3 box;  ///< over the shutter
    /// Largest luminance of its radiant intensity in any direction, with the mean of its image.
    float intensity = 0;
    float radiance = 0;  ///< luminance, mean over the shape
    RayKinds visible_to = kEveryRay;
    std::optional<SpotCone> cone = {};          ///< that the light stays within
    std::optional<LightImage> directions = {};  ///< factor by direction

    /// Factor on its light that it sends in the unit direction w.
    float share_towards(Vec3 w) const {
        const float share = cone ? cone->falloff(w) : 1;
        return directions ? share * luminance((*directions)(w)) : share;
    }
};

/// Share of the light of an emissive shape that gets through the layers above it, at a place and
/// for a cosine between the direction that it leaves in and the normal, above 0.
using EmissionShare = std::function<Rgb(MaterialId, const TexturePoint&, float cosine)>;

class Lights {
  public:
    /// Builds the lights of a scene. Image files that are missing, broken or of an unknown layout
    /// throw Error(scene) with the place in the scene file, those beyond the memory that is left
    /// Error(limit). `geometry` and `textures` must outlive the lights; without textures area
    /// lights have no image, and no alpha but a constant 0. Shapes of instanced objects don't emit.
    Lights(const SceneDescription& scene, const Geometry& geometry,
           const TextureStore* textures = nullptr);
    ~Lights();
    Lights(const Lights&) = delete;
    Lights& operator=(const Lights&) = delete;

    /// Sets what the layers above emitters let through; without it they let everything through.
    /// `share` must be thread-safe; `has_layers` tells the materials that have any.
    void set_layers(const std::function<bool(MaterialId)>& has_layers, EmissionShare share);

    /// Chooses a light for the point p, then a point on it. Empty where the chosen light can't
    /// light p. `u_select` chooses the light. `n` is the unit normal on the side that light is
    /// wanted for: for opaque surfaces the side of the viewer; the zero vector for volumes and
    /// where light counts from both sides. Not all light is found. Finite lights behind n are
    /// chosen seldom; where all of them are behind n and there are infinite lights, never. Uniform
    /// infinite light is found above n only. Where other lights outshine it, it is left to BSDFs
    /// and phase functions, and so is what environment maps have below EnvironmentMap::kLeftOut of
    /// their mean (docs/decisions/0074).
    ///
    /// Uniform infinite lights, environment maps and distant lights with an extent count as one
    /// light here, the sky: `radiance` and `pdf` are those of all of them together. Distant lights
    /// without extent are not among them.
    std::optional<LightSample> sample(Vec3 p, Vec3 n, float time, float u_select, Vec2 u) const {
        return finish_draw(p, n, time, u_select, {u, {}, 0});
    }

    /// The part of a sample that depends on `u` alone: the place where it falls in an environment
    /// map. Begun as soon as u is known, it has the map's memory fetched into the cache while the
    /// path still looks for p (docs/decisions/0060).
    struct Draw {
        Vec2 u;
        EnvironmentMap::Draw sky;
        int steps = 0;  ///< steps of the draw that are done
    };
    /// Whether drawing ahead gains anything: the scene has an environment map without a portal and
    /// no other infinite light, so it is known which one a draw is from. Finite lights do not
    /// matter.
    bool draws_ahead() const;
    /// Does the first step of a draw.
    Draw begin_draw(Vec2 u) const;
    /// Does the second step of a draw, which asks for a texel's memory: best before other work that
    /// takes as long as memory does to answer.
    void continue_draw(Draw& draw) const;
    /// Finishes `sample` with a draw that was taken as far as time allowed. A share of the samples
    /// of the sky, but for its discs, follows `cell`, if there is one.
    /// The choice among finite lights is made with `factors`. With `looks_later` samples that
    /// follow the cell are to be looked at by the caller (LightSample::is_to_be_looked_at), black
    /// ones among them.
    std::optional<LightSample> finish_draw(Vec3 p, Vec3 n, float time, float u_select, Draw draw,
                                           const SkyCell* cell = nullptr,
                                           LightTree::Factors factors = {},
                                           bool looks_later = false) const;

    /// A sample of a finite light to learn from.
    struct Trial {
        std::optional<LightSample> sample;  ///< its pdf is that of the trial
        float place_pdf = 0;  ///< density of the place on the light alone, 1 for delta lights
        std::vector<LightTree::Step> way;  ///< the steps to the light in the tree
    };
    /// Chooses a finite light as LightTree::explore does, then a point on it.
    void try_finite(Vec3 p, Vec3 n, float time, float u_select, Vec2 u, Trial& trial) const;
    /// A finite light beside a ray.
    struct Beside {
        LightTree::Ball ball;  ///< around the light
        /// Share of finite lights among those that would be sampled where the ray comes nearest.
        float share = 0;
    };
    /// Chooses a finite light for a piece of a ray as LightTree::choose_beside does.
    std::optional<Beside> choose_beside(Vec3 origin, Vec3 direction, float length, float& u) const;
    /// Number of the tree's factors that are worth learning; 0 where there is no choice among
    /// finite lights.
    size_t factor_count() const;

    /// Radiance that the surface at `hit` emits towards `wo` (unit, away from the surface), for
    /// what is lit at a distance; infinite for what sees it.
    Rgb emitted(const SurfaceHit& hit, Vec3 wo, float distance = kInfinity) const;
    /// Density per solid angle with which `sample(p, n)` finds the emitter point `hit` in the
    /// direction wi, with the probability of choosing the emitter; with factors, that of
    /// `finish_draw`.
    float pdf(Vec3 p, Vec3 n, Vec3 wi, const SurfaceHit& hit,
              LightTree::Factors factors = {}) const;

    /// Whether there is an infinite light that rays find: a uniform one, an environment map, or a
    /// distant light with an extent.
    bool has_environment() const;
    /// Whether there is one that is more than a disc.
    bool has_sky() const;
    /// Whether rays of a kind find such a one.
    bool has_sky_for(RayKind kind) const;
    /// Whether a direction is one of the disc of a distant light.
    bool is_in_disc(Vec3 w) const;
    /// Radiance of all infinite lights that a ray of a kind finds from the point p in the direction
    /// `w` (unit, away from the scene).
    Rgb environment(Vec3 p, Vec3 w, RayKind kind = RayKind::any) const;
    /// Whether scattered rays of different kinds find different lights. Then a sample of the sky
    /// has the light of all of them: that of one kind is `environment`.
    bool kinds_differ() const;
    /// Radiance from one direction as `environment` has it, and the density per solid angle with
    /// which `sample(p, n)` finds that direction; with a cell, that of `finish_draw`.
    struct Sky {
        Rgb radiance;
        float pdf = 0;
    };
    Sky sky(Vec3 p, Vec3 n, Vec3 w, const SkyCell* cell = nullptr,
            RayKind kind = RayKind::any) const;
    float environment_pdf(Vec3 p, Vec3 n, Vec3 w) const { return sky(p, n, w).pdf; }

    /// Asks for the memory that `environment` and `sky` read for a direction, best before other
    /// work that takes as long as memory does to answer.
    void prefetch_environment(Vec3 w) const;

    /// All emissive shapes that rays can meet, each as a whole.
    std::vector<DistantView> distant_views() const;

    /// Power (radiant flux) that all lights emit; infinite and distant lights count with what
    /// enters the sphere around the scene, or what comes through their portal. Lights that only the
    /// camera sees don't count.
    Rgb total_power() const;
    /// Number of lights: every emissive triangle, patch half, sphere and disk counts as one of its
    /// own.
    int count() const;
    /// Warnings of images whose colour space is not known.
    const Warnings& warnings() const;
    /// Probability that `sample(p, n)` chooses the light. Over all lights it sums to 1, or to less
    /// where a whole group of lights looks away from p: choosing the group then chooses none.
    float selection_probability(Vec3 p, Vec3 n, int light, LightTree::Factors factors = {}) const;

  private:
    friend class LightSpectra;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace covtrace
