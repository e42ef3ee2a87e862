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
    e.position = light_to_world.point(light.from);
    Vec3 axis = normalize(light.to - light.from);
    if (light_to_world.vector(axis) == Vec3{}) axis = {0, 0, 1};
    e.cone = SpotCone::from_degrees(light.cone_angle, light.cone_delta_angle);
    e.intensity = light.intensity;
    if (light.power) e.intensity *= normalisation(*light.power, luminance(power(e)));
    e.cone = SpotCone::from_degrees(light.cone_angle, light.cone_delta_angle, light_to_world, axis);
    e.cone_variance = e.cone->variance();
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
    if (light.cone) {
        e.cone = SpotCone::from_degrees(light.cone->angle, light.cone->delta_angle, light_to_world);
        e.cone_variance = e.cone->variance();
        if (e.image) e.image_integral = e.image->integral(&*e.cone);
    }
    if (light.power) e.intensity *= normalisation(*light.power, luminance(power(e)));
    return e;
}

PointEmitter make_point_emitter(const ProjectionLight& light, const Transform& light_to_world,
                                const SourceLocation& where, Warnings& warnings) {
    PointEmitter e;
    e.position = light_to_world.point({});
    e.intensity = Rgb(light.scale);
    e.image = LightImage::slide(light.image, light.fov, light_to_world, where, warnings);
    e.image_integral = e.image->integral();
    if (light.power) e.intensity *= normalisation(*light.power, luminance(power(e)));
    const float corner = std::acos(e.image->cos_corner()) * (180 / kPi);
    e.cone = SpotCone::from_degrees(corner, corner, light_to_world);
    return e;
}

Rgb intensity(const PointEmitter& light, Vec3 w) {
    Rgb value = light.intensity;
    if (light.image) value *= (*light.image)(w);
    if (light.cone && !(light.image && light.image->is_slide())) value *= light.cone->falloff(w);
    return value;
}

Rgb power(const PointEmitter& light) {
    if (light.image) return light.intensity * light.image_integral;
    return (light.cone ? light.cone->solid_angle() : 4 * kPi) * light.intensity;
}

LightBounds bounds(const PointEmitter& light) {
    LightBounds b;
    b.box.extend(light.position);
    b.intensity = choice_weight(light.intensity);
    b.axis = light.cone ? light.cone->axis() : Vec3{0, 0, 1};
    b.theta_o = light.cone ? light.cone->inner_angle() : kPi;
    b.theta_e = light.cone ? light.cone->outer_angle() - b.theta_o : kPi / 2;
    if (light.image) {
        // The image counts with its mean: over the cone around a slide, else over all directions.
        const float half = light.cone ? light.cone->outer_angle() / 2 : kPi / 2;
        const float solid_angle = 4 * kPi * sqr(std::sin(half));
        b.intensity *= choice_weight(light.image_integral) / solid_angle;
    }
    return b;
}

DistantEmitter make_distant_emitter(const DistantLight& light, const Transform& light_to_world) {
    return {normalize(light_to_world.vector(light.direction)), light.radiance};
}

}  // namespace covtrace
