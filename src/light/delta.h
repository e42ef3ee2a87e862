/// Lights without extent: point and spot lights at a place, distant lights in a direction.
#pragma once

#include <optional>

#include "light/image.h"
#include "light/spot_cone.h"
#include "light/tree.h"
#include "scene/scene_description.h"

namespace covtrace {

/// A point light, a spot light (then with an intensity that falls off smoothly towards the rim of
/// its cone), or a light with an image over the directions.
struct PointEmitter {
    Vec3 position;
    Rgb intensity;  ///< radiant intensity, of a spot within its inner cone
    /// That the light stays within: of a spot, of a goniometric light that has one, and around a
    /// slide, whose light it only bounds.
    std::optional<SpotCone> cone;
    float cone_variance = 0;          ///< of a spot: angular variance along one axis, radians^2
    std::optional<LightImage> image;  ///< multiplies the intensity
    Rgb image_integral;               ///< of the image over all directions
};
PointEmitter make_point_emitter(const PointLight& light, const Transform& light_to_world);
/// Makes a spot light. As in pbrt-v4 its power is measured as if the transform had not stretched
/// its cone.
PointEmitter make_point_emitter(const SpotLight& light, const Transform& light_to_world);
/// Makes a light with an image. Images that are missing, broken or of the wrong shape throw
/// Error(scene) at `where`; colours of an unknown space are a warning.
PointEmitter make_point_emitter(const GoniometricLight& light, const Transform& light_to_world,
                                const SourceLocation& where, Warnings& warnings);
PointEmitter make_point_emitter(const ProjectionLight& light, const Transform& light_to_world,
                                const SourceLocation& where, Warnings& warnings);
/// Radiant intensity towards `w` (unit, away from the light).
Rgb intensity(const PointEmitter& light, Vec3 w);
/// Power that the light emits in all directions together.
Rgb power(const PointEmitter& light);
LightBounds bounds(const PointEmitter& light);

struct DistantEmitter {
    Vec3 direction;  ///< unit, towards the light
    Rgb irradiance;  ///< of a surface that faces it
};
DistantEmitter make_distant_emitter(const DistantLight& light, const Transform& light_to_world);

/// The factor that brings a light, whose luminance amounts to `measured`, to `target`; 0 where it
/// is black.
constexpr float normalisation(float target, float measured) {
    return measured > 0 ? target / measured : 0;
}

}  // namespace covtrace
