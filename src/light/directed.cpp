#include "light/directed.h"

#include <optional>

namespace covtrace {

namespace {

/// The unit normal that all of an emitter has; empty where it has several.
std::optional<Vec3> flat_normal(const Emitter& emitter) {
    return std::visit(
        [](const auto& e) -> std::optional<Vec3> {
            constexpr float kSameCosine = 1 - 1e-5f;
            const Vec3 first = e.light_count() > 0 ? e.bounds(0).axis : Vec3{};
            for (int k = 0; k < e.light_count(); ++k) {
                const LightBounds bounds = e.bounds(k);
                if (bounds.theta_o > 0 || dot(bounds.axis, first) < kSameCosine) return {};
            }
            return first;
        },
        emitter);
}

Rgb integral_over_directions(const AreaLight& area) {
    return area.directions->integral(area.cone ? &*area.cone : nullptr);
}

void set_cone(AreaLight& area, const AreaLightDescription::Cone& cone,
              const ShapeDescription& shape) {
    const Transform& to_world = shape.object_to_world.start();
    area.cone = cone.is_grid ? SpotCone::grid(cone.angle, normalize(to_world.vector({0, 0, 1})))
                             : SpotCone::from_degrees(
                                   cone.angle, cone.delta_angle,
                                   to_world * Transform::scale(cone.stretch.x, cone.stretch.y, 1));
    area.cone_variance = area.cone->variance();
}

}  // namespace

void direct(AreaLight& area, const AreaLightDescription& light, const ShapeDescription& shape,
            Warnings& warnings) {
    if (light.cone) set_cone(area, *light.cone, shape);
    if (light.goniometric)
        area.directions = LightImage::goniometric(*light.goniometric, shape.object_to_world.start(),
                                                  light.where, warnings);
    if (!light.soft_falloff) return;
    area.soft_radius = sphere_radius(area.emitter);
    if (!(area.soft_radius > 0))
        warnings.push_back({light.where,
                            "\"softfalloff\" is of whole spheres; a shape of this light is none "
                            "and shines as without it"});
}

void narrow(LightBounds& bounds, const AreaLight& area) {
    bounds.axis = area.cone->axis();
    bounds.theta_o = area.cone->inner_angle();
    bounds.theta_e = area.cone->outer_angle() - bounds.theta_o;
    bounds.two_sided = false;
}

Rgb mean_over_directions(const AreaLight& area) {
    if (!area.directions) return Rgb(1);
    const float solid_angle = area.cone ? area.cone->solid_angle() : 4 * kPi;
    return integral_over_directions(area) * (1 / solid_angle);
}

Rgb share_let_through(const AreaLight& area) {
    if (area.directions) return integral_over_directions(area) * (1 / (4 * kPi));
    if (!area.cone) return Rgb(1);
    if (const auto normal = flat_normal(area.emitter)) {
        const float front = area.cone->projected_solid_angle(*normal),
                    back = area.two_sided ? area.cone->projected_solid_angle(-*normal) : 0;
        return Rgb((front + back) / (area.two_sided ? 2 * kPi : kPi));
    }
    return Rgb(area.cone->solid_angle() / (4 * kPi));
}

}  // namespace covtrace
