/// An infinite light: the same radiance from everywhere, or an image around the scene.
#pragma once

#include <optional>

#include "core/frame.h"
#include "core/transform.h"
#include "light/environment_map.h"
#include "scene/scene_description.h"

namespace covtrace {

/// All directions are unit vectors in world space that point away from the scene. Transforms need
/// not be rigid: light space is looked up along the transformed direction, and densities follow.
class Environment {
  public:
    /// Reads the light's image, if it has one. Throws as EnvironmentMap::read does.
    Environment(const InfiniteLight& light, const Transform& light_to_world,
                const SourceLocation& where, Warnings& warnings);

    Rgb radiance(Vec3 w) const { return look({}, w).radiance; }
    /// A direction for a surface with the unit normal n; with n zero, for light from all sides.
    /// Uniform light is sampled by the cosine to n, an image as EnvironmentMap does, in the same
    /// three steps.
    EnvironmentMap::Draw begin_draw(Vec2 u) const {
        return map_ ? map_->begin_draw(u) : EnvironmentMap::Draw{u};
    }
    void choose_texel(EnvironmentMap::Draw& draw) const {
        if (map_) map_->choose_texel(draw);
    }
    Vec3 direction(Vec3 n, const EnvironmentMap::Draw& draw) const;
    bool is_map() const { return map_.has_value(); }
    float pdf(Vec3 n, Vec3 w) const { return look(n, w).pdf; }
    /// Radiance and density together, for less than both one by one.
    EnvironmentMap::Sight look(Vec3 n, Vec3 w) const;
    /// Mean radiance over all directions, where the transform is rigid.
    Rgb mean_radiance() const;
    /// Rough irradiance of any surface, mean of the channels: of a map, by the part of its light
    /// that directions are drawn for. 0 where the light is black.
    float irradiance() const;

    /// The image by directions of light space, before `scale`; null where the light is uniform.
    const EnvironmentMap* map() const { return map_ ? &*map_ : nullptr; }
    Rgb scale() const { return scale_; }
    /// A direction in light space, of any length.
    Vec3 to_light(Vec3 w) const { return to_light_(w); }
    const Transform& light_to_world() const { return light_to_world_; }

  private:
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
};

}  // namespace covtrace
