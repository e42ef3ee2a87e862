/// A path in the making, cut at its rays. Only for the files path*.cpp of this folder.
#pragma once

#include <optional>

#include "colour/sampled_wavelength.h"
#include "integrator/panes.h"
#include "integrator/path.h"
#include "integrator/power_heuristic.h"
#include "integrator/visibility.h"
#include "shading/normal_map.h"

namespace covtrace {

/// A path in the making. The estimate is  sum over vertices of  beta * (emission + direct light),
/// beta = product of  f |cos| / pdf  and of the weights of media so far. Lamps of some extent and
/// skies are found by two strategies whose weights add to one, behind panes and by flat mirrors,
/// too; point lights by sampling alone, and light behind other specular lobes, and the glow of
/// media, by the path alone.
class PathTracer {
  public:
    PathTracer(const LitScene& scene, const CausticGuide& guide, const SkyGuide* sky_guide,
               const LampGuide* lamp_guide, const PathGuide* path_guide, Ray ray,
               const Sampler& sampler, int max_depth, PathRecord* record)
        : scene_(scene),
          caustic_guide_(guide),
          sky_guide_(sky_guide),
          lamp_guide_(lamp_guide),
          path_guide_(path_guide),
          ray_(ray),
          sampler_(sampler),
          max_depth_(max_depth),
          record_(record),
          tells_opacity_(scene.tells_opacity && ray.kind == RayKind::camera),
          draws_ahead_(scene.lights.draws_ahead() && (!sky_guide || sky_guide->is_empty())),
          samples_through_panes_(scene.samples_through_panes),
          samples_by_mirrors_(scene.samples_by_mirrors) {
        camera_origin_ = ray.origin;
        medium_ = scene.description.camera.medium;
        if (record_) {
            record_->clear();
            record_->camera_ray = ray;
        }
    }

    /// Lets the path begin at a place where light is sampled, in place of the camera, with a ray
    /// whose direction has the density `pdf`.
    void leave_from(const LitPlace& place, float pdf);
    /// The ray to the next place where the path meets something.
    const Ray& next_ray();
    /// Where the nearest hit of that ray goes.
    SurfaceHit& hit() { return hit_; }
    /// Asks for memory that the path needs next, by whether it has found something.
    void prefetch(bool found);
    /// Goes on to the next ray, given what has become of the last one; returns false where the path
    /// ends. Either way it may have a ray to a light to be followed first.
    bool meet(bool found);
    /// The ray to the light sampled at the current vertex; null where none was.
    const Ray* ray_to_light() const { return sampled_light_ ? &sampled_light_->ray : nullptr; }
    /// Adds the sampled light, unless something solid is in its way. Where that may be panes alone,
    /// its ray stays and is to be looked at again.
    void add_sampled_light(bool occluded);
    /// Adds the light that comes from the direction of the sampled light through panes, unless
    /// something else is in the way of that one.
    void add_light_through_panes(bool blocked);

    const PathResult& result() const { return result_; }

  private:
    static constexpr uint32_t kPairsPerBounce = 4;
    /// First dimension of the media's pairs. Media draw from dimensions of their own, so that
    /// surfaces see the same numbers with or without them: one pair for each piece between
    /// interfaces.
    static constexpr uint32_t kMediumPairs = 1u << 20;
    static constexpr uint32_t kGlowPairs = 3u << 29;  ///< likewise, of emission that varies
    static constexpr uint32_t kWavelengthPair = (1u << 20) - 1;  ///< of the path's wavelength
    static constexpr uint32_t kMirrorPairs = 1u << 19;  ///< first of two per bounce, for mirrors
    /// First dimension of the pairs of walks through bodies: for each of the path's steps inside
    /// those of a vertex, where the walk may leave, then those of the step.
    static constexpr uint32_t kBodyPairs = 1u << 31, kPairsPerBodyStep = 2 * kPairsPerBounce;

    /// A place on a surface with all that scattering there depends on.
    struct Surface {
        const SurfaceHit& hit;
        const PlacedShape& shape;
        const Bsdf& bsdf;
        Frame frame;
        Vec3 wo;  ///< direction towards the viewer, in the frame
    };

    /// Light sampled at a vertex, as it is if nothing is in its way.
    struct SampledLight {
        Ray ray;  ///< towards the light, up to just before it
        /// Unit direction from there to the sampled point itself, which rays through panes are to
        /// meet: the other ray ends beside it, where it may miss a lamp's rim.
        Vec3 to_point;
        float distance = kInfinity;
        MediumId medium = -1;  ///< around the origin of the ray
        Rgb scattered;         ///< what the path scatters of light from there
        Rgb radiance;          ///< the light
        float pdf = 0;         ///< density of the sample
        /// Whether light and density are to be had by its direction (LightSample).
        bool is_to_be_looked_at = false;
        /// Density with which the path would have found its direction; 0 for delta lights.
        float path_pdf = 0;
        LitPlace place;
        PathVertex* vertex = nullptr;
    };

    /// The last place where light was sampled, while the path has since met panes alone and gone
    /// through them, or a flat mirror alone.
    struct Departure {
        LitPlace place;
        Vec3 origin, direction;  ///< of the ray that left it
        float pdf = 0;  ///< density of its direction, and of what the path did at panes or mirror
        float to_pane = 0;       ///< distance of the first pane
        int panes = 0;           ///< that the path went through; -1: it met something else
        int mirror = -1;         ///< that the path met; -1: none
        float mirror_share = 0;  ///< probability that light was sampled there by a mirror
    };

    /// A body that scatters light inside, while the path walks through it.
    struct Body {
        Medium medium;
        MaterialId material = -1;  ///< that the path met
        MaterialId surface = -1;   ///< of the shape: a mix, or `material`
        /// Things inside the body, of other materials, that the path is in: they let it pass.
        int things = 0;
        float eta = 1;      ///< index inside over that outside; 1: the border does not refract
        float entered = 0;  ///< largest component of the throughput as the path came in
        int steps = 0;
    };

    /// A kind of ray, and a factor on what is scattered that leaves the part of that kind alone.
    struct ChosenKind {
        RayKind kind = RayKind::any;
        Rgb factor{1};
    };

    // ---- path.cpp
    bool meet_surface(const SurfaceHit& hit, const PlacedShape& shape, PlacedMaterial placed,
                      Bsdf& bsdf);
    /// The BSDF where a ray hits a material, its textures filtered.
    Bsdf bsdf_at(const SurfaceHit& hit, MaterialId material) const;
    /// Goes on behind a surface that lets the path pass; returns false after too many of them.
    bool pass(const SurfaceHit& hit, const PlacedShape& shape);
    /// Multiplies all light from behind the current hit by the weight of its material.
    void weigh(float weight);
    /// Adds what an emitter that lets light pass sends along the ray.
    void pass_emitter(const SurfaceHit& hit, const PlacedShape& shape);
    /// Whether the path sees the colour of an unlit surface at a hit; else it passes.
    bool is_seen(const UnlitBsdf& unlit, const SurfaceHit& hit) const;
    /// Adds the colour of an unlit surface, where the path ends; returns false.
    bool see_unlit(const UnlitBsdf& unlit, MaterialId material);
    /// The frame of the surface, with the material's bump or normal map.
    Frame frame_at(const SurfaceHit& hit, const PlacedShape& shape, MaterialId material) const;
    /// The frame of the BSDF as it is seen along `wo`, world: turned where lobes about the mirrored
    /// direction would lose their light; see reflecting_normal.h.
    static Frame reflecting_frame(const Frame& unturned, const SurfaceHit& hit, const Bsdf& bsdf,
                                  Vec3 wo);
    /// Gives the clear coat its own normal, turned likewise, in the frame of the BSDF.
    void turn_clearcoat(Bsdf& bsdf, const SurfaceHit& hit, const PlacedShape& shape,
                        MaterialId material, const Frame& frame, Vec3 wo) const;
    Frame mapped_frame(const SurfaceHit& hit, const PlacedShape& shape,
                       const MaterialDescription& material, MappedLayer layer) const;
    PathVertex* begin_vertex(const SurfaceHit& hit, MediumId medium, Vec3 wo);
    /// Tells the result what belongs to the first surface alone.
    void describe_first(const SurfaceHit& hit, Vec3 wo);
    /// Describes the current vertex in the result, if it is the first one or is seen through
    /// mirrors and the like.
    void describe_vertex(Vec3 position, Rgb albedo, Vec3 normal);
    /// Decides by Russian roulette whether the path survives, from the throughput without the
    /// factors that refraction and the guide put on it; a survivor's throughput grows accordingly.
    bool survives(float u);
    bool in_view() const { return sharp_so_far_ && sharp_probability_ > 0.5f; }

    /// Number of the first of the pairs that the vertex to come draws.
    uint32_t pairs_to_come() const;
    /// Adds direct light at a surface and scatters the path there, by the pairs that are next.
    /// `normal`: that of the side which light is sampled for; 0 for both. Returns false where the
    /// path ends.
    bool light_and_scatter(const Surface& surface, Vec3 normal, PathVertex* vertex);

    // ---- path_subsurface.cpp: walks through bodies that scatter light inside
    /// Whether the direction in which light leaves the body that the path is in, above the normal
    /// of shading, goes below the surface, back into the body.
    bool goes_back_in(const Surface& surface, const BsdfSample& s) const;
    /// Goes into the body below a surface, in the sampled direction, or on in the one that the path
    /// is in.
    bool enter_body(const Surface& surface, const BsdfSample& s, PathVertex* vertex);
    /// Takes a step inside, to a place that scatters or to the border, `found`; returns false where
    /// the path ends.
    bool cross_body(bool found);
    /// Leaves the body at the hit.
    bool leave_body(const SurfaceHit& hit, const PlacedShape& shape);
    /// Whether the hit, met from inside, is on the border of the body; else the path has gone into
    /// or out of a thing inside, which is counted.
    bool is_border(const SurfaceHit& hit, const PlacedShape& shape);

    // ---- path_light.cpp: light that is found
    /// Records the way behind the last vertex, where the path ends without another one.
    void record_last_way(float length);
    void escape();
    void add_emission(const SurfaceHit& hit, Vec3 wo, PathVertex* vertex);
    /// Samples a light; `u_kind` chooses the kind of ray that it counts for.
    void add_direct(const Surface& surface, float u_select, Vec2 u, float u_kind,
                    PathVertex* vertex);
    /// Keeps the light sampled at a vertex, which scatters the part `value.f` of it into the path
    /// and would have found its direction with density `value.pdf`, until it is known whether
    /// anything is in its way. `shadow` starts there, in `medium`, and has the kind of the rays
    /// that the part is scattered into. Returns false for no light.
    bool keep_light(LightSample light, const BsdfValue& value, Ray shadow, MediumId medium,
                    PathVertex* vertex);
    /// Looks up light and density of a sample that is to be looked at. Returns false for no light.
    bool look_at(SampledLight& light) const;
    /// Whether shadow rays alone meet something between the last vertex and light that the path
    /// has found at a hit, or in the sky: it counts where it can be sampled (docs/decisions/0112).
    bool is_shadowed(const SurfaceHit* hit);

    // ---- path_panes.cpp
    /// Whether the path has come through panes, and met nothing else, from a place where light was
    /// sampled.
    bool came_through_panes() const { return departure_.panes > 0; }
    /// Whether it has come by a flat mirror alone.
    bool came_by_mirror() const { return departure_.mirror >= 0; }
    /// Adds the light that is found where the direction of a sampled light leads through panes.
    void follow_through_panes(const SampledLight& light);
    /// Notes that the path leaves the last vertex along its ray, where it has sampled light by a
    /// mirror with a probability.
    void leave(float mirror_share);
    /// Notes that it leaves a surface by a specular lobe.
    void leave_specular(const SurfaceHit& hit, const PlacedShape& shape, const BsdfSample& s);
    /// Weight of light that the path has found through panes.
    float weight_through_panes();

    // ---- path_mirrors.cpp
    /// Samples a light as a flat mirror shows it, and adds it.
    void add_mirrored_light(const Surface& surface, PathVertex* vertex);
    /// Finds the flat mirror that a ray meets first, of all that does not let it pass; `medium` and
    /// `passes`, the light that media let through, are those up to there. Returns false where it
    /// meets anything else.
    bool find_mirror(int mirror, Ray ray, SurfaceHit& hit, MediumId& medium, Rgb& passes);
    /// Weight of light that the path has found by a flat mirror: on a surface, or in the sky where
    /// `hit` is null.
    float weight_by_mirror(const SurfaceHit* hit) const;

    // ---- path_scatter.cpp: where the path goes on
    /// Density of sample_direction to return a direction by other than specular lobes, given the
    /// density of the BSDF.
    float mixed_pdf(float own, Vec3 wi) const;
    /// Value of a pair of directions, with the density of mixed_pdf.
    BsdfValue eval_direction(const Surface& surface, Vec3 wi_local, Vec3 wi) const;
    /// Samples a direction by the BSDF or, for a share of the samples, by the guide. The weight
    /// counts both, whichever chose.
    std::optional<BsdfSample> sample_direction(const Surface& surface, float u_lobe, Vec2 u);
    /// Scatters the path; `u_kind` chooses the kind of the new ray.
    bool scatter(const Surface& surface, float u_lobe, Vec2 u, float u_kind, PathVertex* vertex);
    /// Chooses the kind of ray for a pair of directions of which the surface scatters `value`, by
    /// the lobes' luminances.
    ChosenKind choose_kind(const Surface& surface, Vec3 wi_local, Rgb value, float u) const;
    /// Gives a dispersive glass its index at the path's wavelength, which the first such glass
    /// chooses.
    void disperse(DielectricBsdf& glass);
    /// Goes on with the chosen wavelength alone.
    void take_wavelength();

    // ---- path_opacity.cpp
    /// Whether the path is still the camera's ray, straight on, and what it meets is to be told.
    bool looks_straight() const { return tells_opacity_ && depth_ == 0; }
    /// Tells the opacity of a ray that gets to where nothing is seen.
    void tell_clear();
    /// Ends the path at a holdout, as where nothing is seen.
    void end_at_holdout();
    /// Tells the opacity of a ray that leaves the scene.
    void tell_opacity_of_sky();
    /// Tells the opacity of a ray that a medium scatters before the current hit, or the sky.
    void tell_opacity_behind(bool found);
    /// The factor on light that comes straight through the surface at a hit to the camera; 0 where
    /// none does.
    float passed_to_camera(const PlacedShape& shape, const SurfaceHit& hit) const;

    // ---- path_medium.cpp
    /// Whether the path is in a medium that its next ray finds.
    bool is_in_medium() const { return medium_ >= 0 && finds(medium_); }
    bool finds(MediumId medium) const {
        return scene_.media[static_cast<size_t>(medium)].is_seen || depth_ > 0 ||
               ray_.kind != RayKind::camera;
    }
    /// Adds the emission of the medium on the way and decides whether the ray gets through.
    MediumEvent cross_medium(float length);
    /// A light beside the next `length` of the ray, chosen by `u`, which can be used again.
    std::optional<LightBeside> light_beside(float length, float& u) const;
    bool scatter_in_medium(float distance);

    const LitScene& scene_;
    const CausticGuide& caustic_guide_;
    const SkyGuide* const sky_guide_;
    const LampGuide* const lamp_guide_;
    const PathGuide* const path_guide_;
    Ray ray_;
    Sampler sampler_;
    const int max_depth_;
    PathRecord* const record_;

    SurfaceHit hit_;
    std::optional<SampledLight> sampled_light_;
    PathResult result_;
    Rgb beta_{1};
    float pdf_ = 0;  // density of the last sampled direction
    // Whether the last lobe was specular (the camera counts as one): light sampling could not find
    // what the path finds next.
    bool specular_ = true;
    bool sharp_so_far_ = true;  // all lobes so far were specular
    bool seen_clearly_ = true;  // every lobe so far was sharp enough to see through
    float travelled_ = 0;       // length of the path from the camera to the last described vertex
    // Probability of the specular lobes that were chosen, while all were specular.
    float sharp_probability_ = 1;
    /// Wavelength since the first dispersive glass, and whether the throughput has its colour yet.
    std::optional<SampledWavelength> wavelength_;
    bool has_wavelengths_colour_ = false;
    float weighed_ = 1;         // product of the weights of mixtures, for the first vertex's albedo
    Rgb colourless_beta_{1};    // throughput without that colour, for the features
    float roulette_scale_ = 1;  // takes factors of refraction and guide out of beta_ for roulette
    MediumId medium_ = -1;
    int passed_interfaces_ = 0;
    int depth_ = 0;                  // scattering events so far
    std::optional<Body> body_;       // that the path walks through
    uint32_t steps_in_bodies_ = 0;   // so far, in all of them
    float glow_ = 0;                 // luminance from media since the last vertex, for the record
    Vec3 camera_origin_;             // start of the path
    GuideMixture guide_;             // guide to caustics at the current vertex
    PathGuideMixture path_mixture_;  // where light comes from there
    Departure departure_{{}, {}, {}, 0, 0, -1, -1, 0};
    float mirror_share_ = 0;  // probability of sampling light by a mirror at the current vertex
    // Light draw of the vertex to come, begun before that vertex is known.
    Lights::Draw light_draw_;
    Rgb clear_{1};  // transmittance of the camera's ray so far
    const bool tells_opacity_;
    const bool draws_ahead_;  // not where most samples follow the guide to the sky
    const bool samples_through_panes_, samples_by_mirrors_;
    LitPlace lit_;    // the last vertex
    Vec3 ray_begin_;  // where its ray began
    // Length of the way to there from the last event that was not specular
    float specular_way_ = 0;
};

}  // namespace covtrace
