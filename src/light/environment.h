/// An infinite light: the same radiance from everywhere, or an image around the scene.
#pragma once

#include <optional>

#include "core/frame.h"
#include "core/transform.h"
#include "light/environment_map.h"
#include "scene/scene_description.h"
#include "texture/image_spectrum.h"

namespace covtrace {

/// Second moments of the angular amplitude spectrum, (cycles per radian)^2, in the x and y of
/// `tangent`, whose z is the direction that the light travels in.
struct AngularCovariance {
    Frame tangent;
    float a11 = 0, a12 = 0, a22 = 0;
};

/// All directions are unit vectors in world space that point away from the scene. Transforms need
/// not be rigid: light space is looked up along the transformed direction, and densities follow.
class Environment {
  public:
    /// Throws as EnvironmentMap::read.
    Environment(const InfiniteLight& light, const Transform& light_to_world,
                const SourceLocation& where, Warnings& warnings);

    Rgb radiance(Vec3 w) const { return look({}, w).radiance; }
    /// A direction for a surface with the unit normal n, which uniform light is sampled about by
    /// the cosine; n zero: from all sides. In three steps as of a map.
    EnvironmentMap::Draw begin_draw(Vec2 u) const {
        return map_ ? map_->begin_draw(u) : EnvironmentMap::Draw{u};
    }
    void choose_texel(EnvironmentMap::Draw& draw) const {
        if (map_) map_->choose_texel(draw);
    }
    Vec3 direction(Vec3 n, const EnvironmentMap::Draw& draw) const;
    bool is_map() const { return map_.has_value(); }
    float pdf(Vec3 n, Vec3 w) const { return look(n, w).pdf; }
    /// Both at once.
    EnvironmentMap::Sight look(Vec3 n, Vec3 w) const;
    /// Over all directions, of a rigid transform.
    Rgb mean_radiance() const;
    /// Rough irradiance of any surface, mean of the channels, of a map by what directions are drawn
    /// for: 0 where the light is black.
    float irradiance() const;

    /// Measures the image, once; without it the light counts as uniform below.
    void prepare_spectrum();
    AngularCovariance spectrum(Vec3 w) const;
    /// Whether the spectrum is anything but zero.
    bool varies() const { return spectrum_.has_value(); }

  private:
    /// The linear part of a transform, in float: what directions need of it.
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
    std::optional<ImageSpectrum> spectrum_;
    float pole_sine_ = 1;       ///< of the spectrum's rows next to the poles
    bool is_mirrored_ = false;  ///< the light's space in the world
};

}  // namespace covtrace
