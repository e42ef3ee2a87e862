/// An infinite light with extent: the same radiance from everywhere, an image around the scene,
/// either perhaps seen through a portal only, or a disc.
#pragma once

#include <optional>

#include "core/frame.h"
#include "core/transform.h"
#include "light/distant_disc.h"
#include "light/environment_map.h"
#include "light/portal.h"
#include "scene/scene_description.h"

namespace covtrace {

/// All directions are unit vectors in world space that point away from the scene. Transforms need
/// not be rigid: light space is looked up along the transformed direction, and densities follow.
class Environment {
  public:
    /// Reads the light's image, if it has one. Throws as EnvironmentMap::read does.
    Environment(const InfiniteLight& light, const Transform& light_to_world,
                const SourceLocation& where, Warnings& warnings);
    /// Makes the disc of a distant light that has an extent. Scale in the transform does not change
    /// its angle.
    Environment(const DistantLight& light, const Transform& light_to_world);

    /// Radiance that comes to the point p: none past the portal, if there is one.
    Rgb radiance(Vec3 p, Vec3 w) const { return is_open(p, w) ? sky(w) : Rgb(); }
    /// Radiance as if there were no portal.
    Rgb sky(Vec3 w) const { return look_at_sky({}, w).radiance; }
    /// A direction for a surface at p with the unit normal n; with n zero, for light from all
    /// sides. Uniform light is sampled by the cosine to n, an image as EnvironmentMap does, in the
    /// same three steps, and what comes through a portal, or from a disc, from `u` alone.
    EnvironmentMap::Draw begin_draw(Vec2 u) const {
        return is_map() ? map_->begin_draw(u) : EnvironmentMap::Draw{u};
    }
    void choose_texel(EnvironmentMap::Draw& draw) const {
        if (is_map()) map_->choose_texel(draw);
    }
    Vec3 direction(Vec3 p, Vec3 n, const EnvironmentMap::Draw& draw) const;
    /// Whether directions are drawn from the image alone.
    bool is_map() const { return map_ && !portal_; }
    /// Whether the light is the same from everywhere.
    bool is_even() const { return !map_ && !portal_ && !disc_; }
    float pdf(Vec3 p, Vec3 n, Vec3 w) const { return look(p, n, w).pdf; }
    /// Radiance and density together, for less than both one by one.
    EnvironmentMap::Sight look(Vec3 p, Vec3 n, Vec3 w) const;
    /// Asks for the memory that `look` reads of the image.
    void prefetch(Vec3 w) const {
        if (!is_map()) return;
        const Vec3 local = to_light_(w);
        map_->prefetch(is_rigid_ ? local : normalize(local));
    }
    /// The disc, if the light is one.
    const DistantDisc* disc() const { return disc_ ? &*disc_ : nullptr; }
    /// Rough irradiance of a surface at p with the unit normal n, mean of the channels: of a map,
    /// by the part of its light that directions are drawn for. Only that of a disc depends on n. 0
    /// where no light comes.
    float irradiance(Vec3 p, Vec3 n) const;
    /// Power that enters a scene with the given radius, or that comes through the portal. Exact
    /// where the transform is rigid.
    Rgb power(float radius) const;

    /// The image by directions of light space, before `scale`; null where the light is uniform.
    const EnvironmentMap* map() const { return map_ ? &*map_ : nullptr; }
    Rgb scale() const { return scale_; }
    /// A direction in light space, of any length.
    Vec3 to_light(Vec3 w) const { return to_light_(w); }
    const Transform& light_to_world() const { return light_to_world_; }

  private:
    bool is_open(Vec3 p, Vec3 w) const { return !portal_ || portal_->is_open(p, w); }
    EnvironmentMap::Sight look_at_sky(Vec3 n, Vec3 w) const;
    /// The linear part of a transform, in single precision: enough for directions.
    struct Linear {
        Vec3 x, y, z;  ///< columns
        Vec3 operator()(Vec3 v) const { return x * v.x + y * v.y + z * v.z; }
    };
    static Linear linear(const Transform& t);

    Transform light_to_world_;
    Linear to_world_, to_light_;
    bool is_rigid_ = true;
    float determinant_ = 1;  // of the map from world to light, absolute value
    Rgb scale_{1};
    std::optional<EnvironmentMap> map_;
    std::optional<Portal> portal_;
    std::optional<DistantDisc> disc_;
};

}  // namespace covtrace
