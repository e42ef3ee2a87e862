#include "pbrt/light_builder.h"

#include <array>
#include <cmath>

#include "pbrt/ray_visibility.h"
#include "pbrt/spectrum_parameter.h"
#include "pbrt/version_three.h"
#include "scene/names.h"

namespace covtrace {

namespace {

float light_scale(Entity& e) {
    const float scale = e.parameters.number("scale", 1);
    if (scale < 0) e.refuse("scale", "parameter \"scale\" of a light must not be negative");
    return scale;
}

/// The light's colour times its scale.
Rgb light_of(Entity& e, std::string_view name, BuildContext& context) {
    const Rgb colour = light_colour(e.parameters, name, context);
    return scaled_light(colour, light_scale(e), e.where, context);
}

/// Power or illuminance that the light as a whole is to have. pbrt scales light of luminance 1 to
/// the given number and then applies the colour and "scale". Empty where the number isn't positive,
/// as in pbrt.
std::optional<float> target(Entity& e, std::string_view name, Rgb colour_and_scale,
                            const BuildContext& context) {
    const auto v = e.parameters.number(name);
    if (!v || !(*v > 0)) return std::nullopt;
    const SourceLocation where = e.parameters.where(name, e.where);
    return luminance(scaled_light(colour_and_scale, *v, where, context));
}

/// Unit vector between two points of the light; they must differ.
Vec3 direction(Vec3 from, Vec3 to, const Entity& e) {
    const Vec3 d = to - from;
    if (!(length(d) > 0) || !is_finite(d))
        throw Error(ErrorKind::scene, e.where,
                    "\"from\" and \"to\" of the light are the same point");
    return normalize(d);
}

PointLight point_light(Entity& e, BuildContext& context) {
    PointLight light;
    light.intensity = light_of(e, "I", context);
    light.from = e.parameters.triple("from", {});
    light.power = target(e, "power", light.intensity, context);
    return light;
}

/// Reads the angles of a spot's cone, degrees.
void read_cone(ParameterList& p, const SourceLocation& where, float& angle, float& delta_angle) {
    angle = p.number("coneangle", 30);
    delta_angle = p.number("conedeltaangle", 5);
    if (!(angle > 0 && angle <= 180))
        throw Error(ErrorKind::scene, p.where("coneangle", where),
                    "parameter \"coneangle\" must be between 0 and 180 degrees");
    if (!(delta_angle >= 0 && delta_angle <= 2 * angle))
        throw Error(ErrorKind::scene, p.where("conedeltaangle", where),
                    "parameter \"conedeltaangle\" must be between 0 and twice coneangle");
}

/// Reads the angle of the grid before an area light, degrees.
AreaLightDescription::Cone grid(ParameterList& p, const SourceLocation& where) {
    const float angle = p.number("gridangle", 90);
    // Directions of single precision are off by 6e-8 radian, 0.3 % of this angle.
    constexpr float kLeastDegrees = 0.001f;
    if (!(angle >= kLeastDegrees && angle <= 90))
        throw Error(ErrorKind::scene, p.where("gridangle", where),
                    "parameter \"gridangle\" must be between 0.001 and 90 degrees");
    for (const char* other : {"coneangle", "power"})
        if (p.has(other))
            throw Error(ErrorKind::scene, p.where(other, where),
                        "an area light has both " + in_quotes(other) +
                            " and \"gridangle\"; expected one of them");
    return {.angle = angle, .delta_angle = 0, .is_grid = true};
}

/// Reads the factors by which an area light's cone is wider along x and y.
Vec2 cone_stretch(ParameterList& p, const SourceLocation& where) {
    const std::vector<float> values = p.numbers("conestretch");
    if (values.empty()) return {1, 1};
    if (values.size() != 2 || !(values[0] > 0) || !(values[1] > 0))
        throw Error(ErrorKind::scene, p.where("conestretch", where),
                    "parameter \"conestretch\" must be two numbers above 0");
    return {values[0], values[1]};
}

SpotLight spot_light(Entity& e, BuildContext& context) {
    ParameterList& p = e.parameters;
    SpotLight light;
    light.intensity = light_of(e, "I", context);
    light.from = p.triple("from", {});
    light.to = p.triple("to", {0, 0, 1});
    direction(light.from, light.to, e);
    read_cone(p, e.where, light.cone_angle, light.cone_delta_angle);
    light.power = target(e, "power", light.intensity, context);
    return light;
}

DistantLight distant_light(Entity& e, BuildContext& context) {
    DistantLight light;
    light.radiance = light_of(e, "L", context);
    const Vec3 from = e.parameters.triple("from", {}), to = e.parameters.triple("to", {0, 0, 1});
    light.direction = direction(to, from, e);
    // The number itself is the factor: light of luminance 1 has illuminance 1 on a surface that
    // faces it.
    if (const auto v = e.parameters.number("illuminance"); v && *v > 0)
        light.radiance =
            scaled_light(light.radiance, *v, e.parameters.where("illuminance", e.where), context);
    light.angle = e.parameters.number("angle", 0);
    if (!(light.angle >= 0 && light.angle <= 180))
        e.refuse("angle", "parameter \"angle\" must be between 0 and 180 degrees");
    if (light.angle > 0) light.visible_to = visible_to(e);
    return light;
}

/// The corners of a rectangle, in the order around it.
std::array<Vec3, 4> portal(Entity& e) {
    const std::vector<Vec3> p = e.parameters.triples("portal");
    const SourceLocation where = e.parameters.where("portal", e.where);
    if (p.size() != 4)
        throw Error(ErrorKind::scene, where,
                    "a portal has " + std::to_string(p.size()) + " corners; expected 4");
    // Sides and corners are as exact as pbrt wants them.
    constexpr float kTolerance = 1e-3f;
    std::array<Vec3, 4> sides;
    for (size_t i = 0; i < 4; ++i) sides[i] = normalize(p[(i + 1) % 4] - p[i]);
    for (size_t i = 0; i < 4; ++i)
        if (!(std::abs(dot(sides[i], sides[(i + 1) % 4])) <= kTolerance &&
              dot(sides[i], sides[(i + 2) % 4]) <= kTolerance - 1))
            throw Error(ErrorKind::scene, where,
                        "a portal must be a rectangle, with its corners in the order around it");
    return {p[0], p[1], p[2], p[3]};
}

InfiniteLight infinite_light(Entity& e, BuildContext& context) {
    ParameterList& p = e.parameters;
    if (p.has("mapname"))
        throw version_three_error(p.where("mapname", e.where), "parameter \"mapname\"");
    InfiniteLight light;
    const bool has_colour = p.has("L");
    light.radiance = light_of(e, "L", context);
    const std::string file = p.text("filename");
    light.illuminance = target(e, "illuminance", light.radiance, context);
    if (!file.empty()) {
        if (has_colour)
            throw Error(ErrorKind::scene, e.where,
                        "an infinite light has both \"L\" and \"filename\"; expected one of them");
        light.image = context.files.find(file, p.where("filename", e.where));
    }
    if (p.has("portal")) light.portal = portal(e);
    light.visible_to = visible_to(e);
    return light;
}

GoniometricLight goniometric_light(Entity& e, BuildContext& context) {
    GoniometricLight light;
    light.intensity = light_of(e, "I", context);
    light.power = target(e, "power", light.intensity, context);
    if (const std::string file = e.parameters.text("filename"); file.empty())
        context.log.add(e.where, "a goniometric light has no image; it shines alike to all sides");
    else
        light.image = context.files.find(file, e.parameters.where("filename", e.where));
    if (e.parameters.has("coneangle")) {
        light.cone = ConeDescription{};
        read_cone(e.parameters, e.where, light.cone->angle, light.cone->delta_angle);
    }
    return light;
}

ProjectionLight projection_light(Entity& e, BuildContext& context) {
    ParameterList& p = e.parameters;
    ProjectionLight light;
    light.scale = scaled_light(Rgb(1), light_scale(e), e.where, context).r;
    light.power = target(e, "power", Rgb(light.scale), context);
    light.fov = p.number("fov", 90);
    if (!(light.fov > 0 && light.fov < 180))
        throw Error(ErrorKind::scene, p.where("fov", e.where),
                    "parameter \"fov\" must be between 0 and 180 degrees");
    const std::string file = p.text("filename");
    if (file.empty())
        throw Error(ErrorKind::scene, e.where,
                    "a projection light has no image; expected \"string filename\"");
    light.image = context.files.find(file, p.where("filename", e.where));
    return light;
}

}  // namespace

LightDescription build_light(Entity& e, const Transform& light_to_world, BuildContext& context) {
    LightDescription light;
    light.light_to_world = light_to_world;
    light.where = e.where;
    if (e.type == "point") {
        light.value = point_light(e, context);
    } else if (e.type == "spot") {
        light.value = spot_light(e, context);
    } else if (e.type == "distant") {
        light.value = distant_light(e, context);
    } else if (e.type == "infinite") {
        light.value = infinite_light(e, context);
    } else if (e.type == "goniometric") {
        light.value = goniometric_light(e, context);
    } else if (e.type == "projection") {
        light.value = projection_light(e, context);
    } else {
        throw unknown_type_error(
            e.where, "light", e.type,
            {"point", "spot", "distant", "infinite", "goniometric", "projection"});
    }
    e.parameters.warn_unused(context.log, "light " + in_quotes(e.type));
    return light;
}

AreaLightDescription build_area_light(Entity& e, BuildContext& context) {
    if (e.type != "diffuse") throw unknown_type_error(e.where, "area light", e.type, {"diffuse"});
    ParameterList& p = e.parameters;
    AreaLightDescription light;
    light.where = e.where;
    const bool has_colour = p.has("L");
    light.radiance = light_of(e, "L", context);
    light.two_sided = p.flag("twosided", false);
    light.lets_light_pass = p.flag("letslightpass", false);
    light.soft_falloff = p.flag("softfalloff", false);
    light.power = target(e, "power", light.radiance, context);
    if (p.has("coneangle")) {
        if (light.power)
            throw Error(
                ErrorKind::scene, p.where("power", e.where),
                "an area light has both \"power\" and \"coneangle\"; expected \"L\" beside a "
                "cone");
        light.cone = AreaLightDescription::Cone{};
        read_cone(p, e.where, light.cone->angle, light.cone->delta_angle);
        light.cone->stretch = cone_stretch(p, e.where);
    }
    if (p.has("gridangle")) light.cone = grid(p, e.where);
    if (const std::string file = p.text("filename"); !file.empty()) {
        const SourceLocation where = p.where("filename", e.where);
        if (has_colour)
            throw Error(ErrorKind::scene, e.where,
                        "an area light has both \"L\" and \"filename\"; expected one of them");
        ImageTexture image;
        image.file = context.files.find(file, where);
        image.wrap = ImageTexture::Wrap::clamp;
        light.image = static_cast<TextureId>(context.scene.textures.size());
        context.scene.textures.push_back({{}, true, image, where});
    }
    if (const std::string file = p.text("goniometricfilename"); !file.empty()) {
        if (light.power)
            throw Error(ErrorKind::scene, p.where("power", e.where),
                        "an area light has both \"power\" and \"goniometricfilename\"; expected "
                        "\"L\" beside an image over its directions");
        light.goniometric = context.files.find(file, p.where("goniometricfilename", e.where));
    }
    p.warn_unused(context.log, "area light \"diffuse\"");
    return light;
}

}  // namespace covtrace
