/// The tables behind Lights. Lights are numbered: emissive triangles, patch halves and quadrics
/// shape by shape, then point and spot lights, then distant ones, then infinite ones with extent.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "light/delta.h"
#include "light/environment.h"
#include "light/lights.h"
#include "light/mesh.h"
#include "light/quadric.h"
#include "light/tree.h"

namespace covtrace {

/// One emissive shape with all its lights.
struct AreaLight {
    uint32_t shape = 0;  ///< index into Geometry::shapes()
    Rgb radiance;        ///< emitted where image and alpha are 1
    bool two_sided = false;
    TextureId image = -1, alpha = -1;  ///< textures that the radiance varies by; -1: none
    bool is_visible = true;  ///< false where a constant alpha of 0 hides the shape from all rays
    RayKinds visible_to = kEveryRay;
    std::optional<SpotCone> cone;          ///< that the light stays within
    float cone_variance = 0;               ///< SpotCone::variance
    std::optional<LightImage> directions;  ///< factor by the direction that the light leaves in
    float soft_radius = 0;   ///< of a sphere with AreaLightDescription::soft_falloff; 0: none
    MaterialId layers = -1;  ///< material whose layers the light has to get through; -1: none
    Rgb mean_factor{1};      ///< mean of image and alpha together
    int first_light = 0;     ///< id of its first light
    Emitter emitter;

    bool varies() const { return image >= 0 || alpha >= 0 || layers >= 0 || cone || directions; }
};

/// The balance between all infinite lights and all finite ones at a point, for choosing among them.
struct InfiniteShare {
    float probability = 0;  ///< probability of choosing any infinite light
    float weight = 0;  ///< sum of infinite_weight, by which infinite lights share `probability`
    /// Factor on the weight of even skies (uniform infinite lights): less where other light
    /// outshines them, as BSDFs find them too (docs/decisions/0074).
    float even = 1;
};

/// The radius in world space of an emitter that is a whole sphere; 0 for others.
inline float sphere_radius(const Emitter& emitter) {
    const auto* ball = std::get_if<EmissiveQuadric>(&emitter);
    return ball && ball->is_whole_sphere() ? std::sqrt(ball->area(0) / (4 * kPi)) : 0.0f;
}

struct Lights::Impl {
    Impl(const SceneDescription& scene, const Geometry& geometry, const TextureStore* textures);

    /// The share of a sphere's light that a disc that faces p gives there: the irradiances are
    /// I / (d^2 + r^2) and I / d^2. 1 for lights without soft falloff, and as seen from afar.
    float softened(const AreaLight& area, Vec3 p, float time) const {
        if (!(area.soft_radius > 0)) return 1;
        const Vec3 centre = geometry->world_from_object(area.shape, time).point({}).to_float();
        const float d2 = length_squared(centre - p);
        return std::isfinite(d2) ? d2 / (d2 + sqr(area.soft_radius)) : 1;
    }
    /// The place of a sampled point of an emitter, for textures.
    template <typename Emitter>
    TexturePoint texture_point(const Emitter& e, int light, const EmitterPoint& point,
                               float time) const {
        TexturePoint at{
            e.uv(light, point, time), point.position, {}, point.normal, e.vertices(light, point)};
        if (textures && textures->has_facing()) {
            const Vec3 normal = e.shading_normal(light, point, time);
            const float cosine = std::min(1.0f, std::abs(dot(normal, point.wi)));
            at.facing = dot(point.normal, point.wi) > 0 ? -cosine : cosine;
        }
        return at;
    }
    /// Radiance of an area light at a place with the unit normal n, by its images, its cone and the
    /// layers above it, in a unit direction w away from it; alpha does not count.
    Rgb radiance_at(const AreaLight& area, const TexturePoint& at, Vec3 n, Vec3 w) const;

    /// Notes which rays find a light; returns whether any scattered ones do.
    bool note_kinds(RayKinds visible_to);
    void add_light(const LightDescription& light);
    void add_distant(const DistantLight& light, const Transform& light_to_world);
    void add_environment(const InfiniteLight& light, const LightDescription& placed);

    /// A sample of a light that was chosen with the given probability; empty where it can't light
    /// p.
    std::optional<LightSample> sample_finite(int light, float probability, Vec3 p, float time,
                                             Vec2 u) const;
    std::optional<LightSample> sample_area(int light, float probability, Vec3 p, float time,
                                           Vec2 u) const;
    std::optional<LightSample> sample_point(int light, float probability, Vec3 p) const;
    /// Chooses an infinite light by its weight, then a direction. `looks_later`: as of
    /// Lights::finish_draw.
    std::optional<LightSample> sample_infinite(const InfiniteShare& share, Vec3 p, Vec3 n,
                                               float u_select, Draw draw, const SkyCell* cell,
                                               bool looks_later) const;
    /// Takes a draw of `light` up to the given number of steps (Lights::Draw::steps).
    void advance(const Environment& light, Draw& draw, int steps) const;

    InfiniteShare infinite_share(Vec3 p, Vec3 n) const;
    /// Weight of infinite light i (distant ones come first) for choosing among them.
    float infinite_weight(const InfiniteShare& share, size_t i, Vec3 p, Vec3 n) const;
    Sky sky(const InfiniteShare& share, Vec3 p, Vec3 n, Vec3 w, const SkyCell* cell,
            RayKind kind) const;
    Rgb environment(Vec3 p, Vec3 w, RayKind kind) const;

    /// The area light of the shape that was hit; null where the shape does not emit.
    const AreaLight* area_light_of(const SurfaceHit& hit) const;
    int first_point() const { return static_cast<int>(owner.size()); }
    int first_distant() const { return first_point() + static_cast<int>(points.size()); }
    int first_environment() const { return first_distant() + static_cast<int>(distants.size()); }
    size_t infinite_count() const { return distants.size() + environments.size(); }

    const Geometry* geometry;
    const TextureStore* textures;
    std::vector<int> area_light_of_shape;  ///< into area_lights, -1 for shapes that don't emit
    std::vector<AreaLight> area_lights;
    std::vector<uint32_t> owner;  ///< for each area light's id, an index into area_lights
    std::vector<PointEmitter> points;
    std::vector<DistantEmitter> distants;
    std::vector<Environment> environments;  ///< with the discs of distant lights that have one
    std::vector<RayKinds> environment_visible_to;  ///< for the environment of the same index
    bool kinds_differ = false;
    EmissionShare emission_share;
    Warnings warnings;
    LightTree tree;  ///< over the ids of area and point lights
};

}  // namespace covtrace
