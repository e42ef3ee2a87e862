#include "scene/added_lamps.h"

#include <array>
#include <charconv>
#include <string>
#include <utility>

namespace covtrace {

namespace {

/// Adds the sphere of a lamp: light passes it, and the camera does not see it.
void add_sphere(LampDescription& lamp, SceneDescription& scene) {
    const auto index = [](const auto& list) { return static_cast<int>(list.size() - 1); };
    scene.textures.push_back({{}, true, ConstantTexture{Rgb(0)}, {}});
    MaterialDescription black;
    black.value = DiffuseMaterial{index(scene.textures)};
    scene.materials.push_back(black);
    AreaLightDescription light;
    light.radiance = lamp.colour;
    light.lets_light_pass = true;
    scene.area_lights.push_back(light);
    lamp.area_light = index(scene.area_lights);
    ShapeDescription sphere;
    sphere.geometry = Sphere{lamp.radius, -lamp.radius, lamp.radius, 360};
    sphere.object_to_world = AnimatedTransform(Transform::translate(*lamp.at));
    sphere.material = index(scene.materials);
    sphere.area_light = lamp.area_light;
    sphere.visible_to &= static_cast<RayKinds>(~set_of(RayKind::camera));
    scene.shapes.push_back(std::move(sphere));
}

/// The shortest text that gives the same number when it is read.
std::string shortest(float value) {
    std::array<char, 32> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

}  // namespace

std::string lamp_text(const LampDescription& lamp) {
    const auto three = [](float a, float b, float c) {
        return shortest(a) + ',' + shortest(b) + ',' + shortest(c);
    };
    std::string text = lamp.at ? three(lamp.at->x, lamp.at->y, lamp.at->z) : "camera";
    if (lamp.radius > 0) text += " radius " + shortest(lamp.radius);
    const Rgb& c = lamp.colour;
    if (!(c == Rgb(1))) text += " colour " + three(c.r, c.g, c.b);
    if (lamp.power) text += " power " + shortest(*lamp.power);
    return text;
}

void add_lamps(const std::vector<LampDescription>& lamps, SceneDescription& scene) {
    if (lamps.empty()) return;
    scene.no_lights.reset();
    scene.glow_alone.reset();
    std::string text;
    for (LampDescription lamp : lamps) {
        if (!text.empty()) text += " and ";
        text += lamp_text(lamp);
        if (lamp.at && lamp.radius > 0) add_sphere(lamp, scene);
        scene.lamps.push_back(lamp);
    }
    scene.lamps_text = text;
}

}  // namespace covtrace
