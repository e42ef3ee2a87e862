#include "render/environment_override.h"

#include <algorithm>
#include <sstream>

#include "core/error.h"
#include "scene/up_axis.h"

namespace covtrace {

namespace {

InfiniteLight* infinite(LightDescription& light) {
    return std::get_if<InfiniteLight>(&light.value);
}

/// Throws where there is no infinite light that `option` could change.
void require_infinite(SceneDescription& scene, const char* option) {
    if (std::none_of(scene.lights.begin(), scene.lights.end(),
                     [](LightDescription& light) { return infinite(light); }))
        throw Error(ErrorKind::usage, OptionName{option},
                    "the scene has no light from all around; expected an environment, too");
}

/// The override as text for a render's identity. An image is known by its content, not its name.
std::string text(const SceneOverrides& overrides) {
    std::ostringstream out;
    out.precision(9);
    if (const auto& e = overrides.environment; e && e->image)
        out << "an image";
    else if (e)
        out << e->radiance.r << ',' << e->radiance.g << ',' << e->radiance.b;
    else
        out << "the scene's";
    if (const float degrees = overrides.environment_rotation.value_or(0); degrees != 0)
        out << " turned by " << degrees;
    if (const float scale = overrides.environment_scale.value_or(1); scale != 1)
        out << " times " << scale;
    return out.str();
}

}  // namespace

void replace_environment(const EnvironmentOverride& environment, SceneDescription& scene) {
    Transform light_to_world = upright_light(scene);
    for (LightDescription& light : scene.lights)
        if (const InfiniteLight* own = infinite(light); own && own->image) {
            light_to_world = light.light_to_world;
            break;
        }
    std::erase_if(scene.lights, [](LightDescription& light) { return infinite(light) != nullptr; });
    const bool has_no_light = scene.no_lights.has_value();
    scene.no_lights.reset();
    scene.glow_alone.reset();
    if (!environment.image && is_black(environment.radiance)) return;
    scene.is_lit_from_outside = has_no_light;
    InfiniteLight light;
    light.image = environment.image;
    if (!environment.image) light.radiance = environment.radiance;
    if (environment.image) scene.files.push_back(environment.image->lexically_normal());
    scene.lights.push_back({light, light_to_world, {}});
}

void change_environment(const SceneOverrides& overrides, SceneDescription& scene) {
    const auto& environment = overrides.environment;
    const auto& rotation = overrides.environment_rotation;
    const auto& scale = overrides.environment_scale;
    if (!environment && !rotation && !scale) return;
    // Nothing is left to be turned where the light was taken away on purpose.
    if (rotation && !environment) require_infinite(scene, "environment_rotation");
    if (scale && !environment) require_infinite(scene, "environment_scale");
    for (LightDescription& light : scene.lights) {
        InfiniteLight* own = infinite(light);
        if (!own) continue;
        if (rotation)
            light.light_to_world =
                light.light_to_world * Transform::rotate(-double(*rotation), {0, 0, 1});
        if (scale) own->radiance *= *scale;
        if (scale && own->illuminance) *own->illuminance *= *scale;
        if (!is_finite(own->radiance))
            throw Error(ErrorKind::usage, OptionName{"environment_scale"},
                        "the light is more than single precision holds");
    }
    scene.environment_override = text(overrides);
}

}  // namespace covtrace
