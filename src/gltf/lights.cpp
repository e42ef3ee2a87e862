#include "gltf/lights.h"

#include <algorithm>
#include <cmath>

#include "gltf/units.h"

namespace covtrace::gltf {
namespace {

Rgb light_colour(const Document& document, const tinygltf::Light& light, const std::string& place) {
    if (!(light.intensity >= 0 && light.intensity < 1e30))
        document.refuse(place + ".intensity", "expected a number of at least 0");
    if (light.color.empty()) return Rgb(static_cast<float>(light.intensity));
    if (light.color.size() != 3) document.refuse(place + ".color", "expected 3 numbers");
    Rgb colour;
    for (int c = 0; c < 3; ++c) {
        const double v = light.color[static_cast<size_t>(c)];
        if (!(v >= 0 && v < 1e30))
            document.refuse(place + ".color", "expected numbers of at least 0");
        colour[c] = static_cast<float>(v * light.intensity);
    }
    if (!is_finite(colour))
        document.refuse(place, "expected a product of color and intensity below 3.4e38");
    return colour;
}

}  // namespace

void add_light(const Document& document, const PlacedNode& placed, SceneDescription& scene,
               WarningLog& log) {
    const tinygltf::Node& node = document.model.nodes[static_cast<size_t>(placed.node)];
    const auto* reference = extension(node.extensions, "KHR_lights_punctual");
    if (!reference) return;
    const std::string node_place =
        element("nodes", static_cast<size_t>(placed.node)) + ".extensions.KHR_lights_punctual";
    const int index =
        static_cast<int>(number(document, *reference, "light", -1, 0, 1e9, node_place));
    const tinygltf::Light& light =
        at(document, document.model.lights, index, "lights", node_place + ".light");
    const std::string place =
        "extensions.KHR_lights_punctual." + element("lights", static_cast<size_t>(index));
    const Rgb colour = light_colour(document, light, place);
    if (is_black(colour)) return;
    if (placed.transform.is_animated())
        log.add(document.place(node_place),
                "moving lights stand still, where they are when the shutter opens");
    const Transform& to_world = placed.transform.start();
    const Vec3 position = to_world.point({0, 0, 0});
    const Vec3 forward = normalize(to_world.vector({0, 0, -1}));

    LightDescription description;
    description.where = document.place(place);
    if (light.type == "point") {
        PointLight point;
        point.intensity = colour;
        point.from = position;
        description.value = point;
    } else if (light.type == "spot") {
        const double outer = light.spot.outerConeAngle, inner = light.spot.innerConeAngle;
        if (!(inner >= 0 && inner < outer && outer <= M_PI / 2 + 1e-6))
            document.refuse(place + ".spot",
                            "expected 0 <= innerConeAngle < outerConeAngle <= pi / 2");
        SpotLight spot;
        spot.intensity = colour;
        spot.from = position;
        spot.to = position + forward;
        spot.cone_angle = std::min(static_cast<float>(outer) * kDegrees, 90.0f);
        spot.cone_delta_angle = static_cast<float>(outer - inner) * kDegrees;
        description.value = spot;
    } else if (light.type == "directional") {
        DistantLight distant;
        distant.radiance = colour;
        distant.direction = -forward;
        description.value = distant;
    } else {
        document.refuse(place + ".type", "expected point, spot or directional");
    }
    scene.lights.push_back(description);
}

namespace {

/// Illuminance by a light on a surface in the middle of the scene that faces it. Lamps inside the
/// scene count from half its radius at least.
float illuminance(const LightDescription& light, const Bounds3& bounds) {
    const auto from = [&](Vec3 position, Rgb intensity) {
        const float distance = std::max(length(position - bounds.center()), 0.5f * bounds.radius());
        return distance > 0 ? luminance(intensity) / sqr(distance) : 0;
    };
    if (const auto* point = std::get_if<PointLight>(&light.value))
        return from(point->from, point->intensity);
    if (const auto* spot = std::get_if<SpotLight>(&light.value))
        return from(spot->from, spot->intensity);
    return luminance(std::get<DistantLight>(light.value).radiance);
}

}  // namespace

void scale_lights(const Document& document, const Bounds3& bounds,
                  std::span<const std::vector<LightDescription>> judged, SceneDescription& scene,
                  WarningLog& log) {
    float most = 0;
    for (const std::vector<LightDescription>& lights : judged) {
        float sum = 0;
        for (const LightDescription& light : lights) sum += illuminance(light, bounds);
        most = std::max(most, sum);
    }
    if (!(most > kPhysicalLux)) return;
    constexpr float kScale = 1 / kLumensPerWatt;
    for (LightDescription& light : scene.lights) {
        if (auto* point = std::get_if<PointLight>(&light.value))
            point->intensity *= kScale;
        else if (auto* spot = std::get_if<SpotLight>(&light.value))
            spot->intensity *= kScale;
        else
            std::get<DistantLight>(light.value).radiance *= kScale;
    }
    log.add(document.place("extensions.KHR_lights_punctual"),
            "the lights give about " + std::to_string(std::lround(most)) +
                " lux, physical units: candela and lux are divided by 683 lm/W");
}

}  // namespace covtrace::gltf
