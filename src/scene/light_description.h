/// Lights that are not shapes, as plain data. Lengths are in scene units, angles in degrees,
/// colours linear Rec.709.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <variant>

#include "core/error.h"
#include "core/transform.h"
#include "core/vec.h"
#include "scene/ray_kind.h"

namespace covtrace {

/// The half angle that a light stays within, and over how much of it the light falls off.
struct ConeDescription {
    float angle = 30, delta_angle = 5;
};
struct PointLight {
    Rgb intensity{1};
    std::optional<float> power;  ///< of all directions, in place of the intensity's size
    Vec3 from;
};
struct SpotLight {
    Rgb intensity{1};
    std::optional<float> power;  ///< of all directions, in place of the intensity's size
    Vec3 from, to{0, 0, 1};
    float cone_angle = 30, cone_delta_angle = 5;
};
/// A point light whose intensity an image modulates, square and equal-area over all directions.
struct GoniometricLight {
    Rgb intensity{1};
    std::optional<float> power;  ///< of all directions, in place of the intensity's size
    std::optional<std::filesystem::path> image;
    std::optional<ConeDescription> cone = {};  ///< about the z axis, as a SpotLight's
};
/// A slide projector at the origin that looks along +z.
struct ProjectionLight {
    float scale = 1;             ///< of the image's radiant intensity
    std::optional<float> power;  ///< of all directions, in place of `scale`
    float fov = 90;              ///< of the image's shorter side, degrees
    std::filesystem::path image;
};
struct DistantLight {
    Rgb radiance{1};          ///< irradiance on a surface that faces it
    Vec3 direction{0, 0, 1};  ///< from the scene towards the light, light space, unit length
    float angle = 0;          ///< degrees across the disc that it shines from, in [0, 180]
    RayKinds visible_to = kEveryRay;  ///< rays that find a light with extent; always `any`
};
/// A light that changes with the height alone: its radiance straight down, level and straight up in
/// light space, in between linear in the sine of the elevation.
struct HeightGradient {
    float down = 1, level = 1, up = 1;
};
struct InfiniteLight {
    Rgb radiance{1};  ///< of the uniform light; multiplies the image or the gradient
    std::optional<std::filesystem::path>
        image;  ///< equal-area octahedral square, or lat-long 2:1 with z as the pole
    /// Illuminance on a surface that faces +z of light space, which scales the whole light, colour
    /// and "scale" included.
    std::optional<float> illuminance;
    /// Corners, in world space, of a rectangle that all of the light comes through, in the
    /// direction (p3 - p0) x (p1 - p0) seen from what it lights; opposite ones are 0 and 2.
    std::optional<std::array<Vec3, 4>> portal = {};
    std::optional<HeightGradient> gradient = {};  ///< where there is no image
    RayKinds visible_to = kEveryRay;  ///< rays that find the light; always `any`
};
struct LightDescription {
    std::variant<PointLight, SpotLight, GoniometricLight, ProjectionLight, DistantLight,
                 InfiniteLight>
        value;
    Transform light_to_world;  ///< at the start of the shutter
    SourceLocation where;
};

}  // namespace covtrace
