#include "light/delta.h"

#include <cmath>

#include "light/weight.h"

namespace covtrace {

namespace {

float radians(float degrees) {
    return degrees * (kPi / 180);
}

float smoothstep(float x) {
    x = clamp01(x);
    return x * x * (3 - 2 * x);
}

/// The factor in [0, 1] on a spot light's intensity in a direction with this cosine to its axis, as
/// in pbrt-v4: 1 in the inner cone, 0 outside the outer one, a smoothstep of the cosine between.
float falloff(const PointEmitter& light, float cosine) {
    if (cosine >= light.cos_inner) return 1;
    if (cosine <= light.cos_outer) return 0;
    return smoothstep((cosine - light.cos_outer) / (light.cos_inner - light.cos_outer));
}

/// Angular variance of a spot light along one axis across its own, radians^2: half the mean squared
/// angle to its axis over the solid angle of the cone, weighted by the intensity. Steps of equal
/// cosine have equal solid angles; 256 of them leave a relative error below 1e-4.
float cone_variance(const PointEmitter& light) {
    constexpr int kSteps = 256;
    double weight = 0, square = 0;
    for (int i = 0; i < kSteps; ++i) {
        const float cosine = 1 - (1 - light.cos_outer) * (float(i) + 0.5f) / kSteps;
        const double angle = std::acos(cosine), f = falloff(light, cosine);
        weight += f;
        square += f * angle * angle;
    }
    return weight > 0 ? static_cast<float>(0.5 * square / weight) : 0.0f;
}

}  // namespace

PointEmitter make_point_emitter(const PointLight& light, const Transform& light_to_world) {
    PointEmitter e;
    e.position = light_to_world.point(light.from);
    e.intensity = light.intensity;
    if (light.power) e.intensity *= normalisation(*light.power, luminance(power(e)));
    return e;
}

PointEmitter make_point_emitter(const SpotLight& light, const Transform& light_to_world) {
    PointEmitter e;
    e.is_spot = true;
    e.position = light_to_world.point(light.from);
    e.axis = normalize(light_to_world.point(light.to) - e.position);
    if (e.axis == Vec3{}) e.axis = normalize(light_to_world.vector({0, 0, 1}));
    const float outer = std::clamp(light.cone_angle, 0.0f, 180.0f);
    // pbrt-v4 takes the cosine of the difference, so the sign of a negative one does not count.
    const float inner =
        std::clamp(std::abs(light.cone_angle - light.cone_delta_angle), 0.0f, outer);
    e.cos_outer = std::cos(radians(outer));
    e.cos_inner = std::cos(radians(inner));
    e.intensity = light.intensity;
    if (light.power) e.intensity *= normalisation(*light.power, luminance(power(e)));
    e.cone_variance = cone_variance(e);
    return e;
}

PointEmitter make_point_emitter(const GoniometricLight& light, const Transform& light_to_world,
                                const SourceLocation& where, Warnings& warnings) {
    PointEmitter e;
    e.position = light_to_world.point({});
    e.intensity = light.intensity;
    if (light.image) {
        e.image = LightImage::goniometric(*light.image, light_to_world, where, warnings);
        e.image_integral = e.image->integral();
    }
    if (light.power) e.intensity *= normalisation(*light.power, luminance(power(e)));
    return e;
}

PointEmitter make_point_emitter(const ProjectionLight& light, const Transform& light_to_world,
                                const SourceLocation& where, Warnings& warnings) {
    PointEmitter e;
    e.position = light_to_world.point({});
    e.axis = normalize(light_to_world.vector({0, 0, 1}));
    e.intensity = Rgb(light.scale);
    e.image = LightImage::slide(light.image, light.fov, light_to_world, where, warnings);
    e.image_integral = e.image->integral();
    if (light.power) e.intensity *= normalisation(*light.power, luminance(power(e)));
    e.cos_outer = e.image->cos_corner();
    e.cos_inner = 1;
    return e;
}

Rgb intensity(const PointEmitter& light, Vec3 w) {
    if (light.image) return light.intensity * (*light.image)(w);
    return light.is_spot ? light.intensity * falloff(light, dot(light.axis, w)) : light.intensity;
}

Rgb power(const PointEmitter& light) {
    if (light.image) return light.intensity * light.image_integral;
    // The fall-off, a smoothstep in the cosine, lets half of its range through.
    const float angle =
        light.is_spot ? 2 * kPi * ((1 - light.cos_inner) + (light.cos_inner - light.cos_outer) / 2)
                      : 4 * kPi;
    return angle * light.intensity;
}

LightBounds bounds(const PointEmitter& light) {
    LightBounds b;
    b.box.extend(light.position);
    b.intensity = choice_weight(light.intensity);
    b.axis = light.axis;
    const bool is_cone = light.is_spot || (light.image && light.image->is_slide());
    b.theta_o = is_cone ? std::acos(light.cos_inner) : kPi;
    b.theta_e = is_cone ? std::acos(light.cos_outer) - b.theta_o : kPi / 2;
    if (light.image) {
        // The image counts with its mean: over the cone around a slide, else over all directions.
        const float solid_angle = is_cone ? 2 * kPi * (1 - light.cos_outer) : 4 * kPi;
        b.intensity *= choice_weight(light.image_integral) / solid_angle;
    }
    return b;
}

DistantEmitter make_distant_emitter(const DistantLight& light, const Transform& light_to_world) {
    return {normalize(light_to_world.vector(light.direction)), light.radiance};
}

}  // namespace covtrace
