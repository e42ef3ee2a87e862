#include "light/delta.h"

#include <cmath>

#include "light/weight.h"

namespace covtrace {

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
    e.cone = SpotCone::from_degrees(light.cone_angle, light.cone_delta_angle);
    e.intensity = light.intensity;
    if (light.power) e.intensity *= normalisation(*light.power, luminance(power(e)));
    e.cone_variance = e.cone.variance();
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
    e.cone = {1, e.image->cos_corner()};
    return e;
}

Rgb intensity(const PointEmitter& light, Vec3 w) {
    if (light.image) return light.intensity * (*light.image)(w);
    return light.is_spot ? light.intensity * light.cone.falloff(dot(light.axis, w))
                         : light.intensity;
}

Rgb power(const PointEmitter& light) {
    if (light.image) return light.intensity * light.image_integral;
    return (light.is_spot ? light.cone.solid_angle() : 4 * kPi) * light.intensity;
}

LightBounds bounds(const PointEmitter& light) {
    LightBounds b;
    b.box.extend(light.position);
    b.intensity = choice_weight(light.intensity);
    b.axis = light.axis;
    const bool is_cone = light.is_spot || (light.image && light.image->is_slide());
    b.theta_o = is_cone ? std::acos(light.cone.cos_inner) : kPi;
    b.theta_e = is_cone ? std::acos(light.cone.cos_outer) - b.theta_o : kPi / 2;
    if (light.image) {
        // The image counts with its mean: over the cone around a slide, else over all directions.
        const float solid_angle = is_cone ? 2 * kPi * (1 - light.cone.cos_outer) : 4 * kPi;
        b.intensity *= choice_weight(light.image_integral) / solid_angle;
    }
    return b;
}

DistantEmitter make_distant_emitter(const DistantLight& light, const Transform& light_to_world) {
    return {normalize(light_to_world.vector(light.direction)), light.radiance};
}

}  // namespace covtrace
