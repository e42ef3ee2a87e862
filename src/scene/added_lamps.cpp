#include "scene/added_lamps.h"

#include <sstream>
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

}  // namespace

void add_lamps(const std::vector<LampDescription>& lamps, SceneDescription& scene) {
    if (lamps.empty()) return;
    scene.no_lights.reset();
    std::ostringstream text;
    text.precision(9);
    for (LampDescription lamp : lamps) {
        if (!scene.lamps.empty()) text << " and ";
        if (lamp.at)
            text << lamp.at->x << ',' << lamp.at->y << ',' << lamp.at->z;
        else
            text << "camera";
        text << " radius " << lamp.radius << " colour " << lamp.colour.r << ',' << lamp.colour.g
             << ',' << lamp.colour.b;
        if (lamp.power) text << " power " << *lamp.power;
        if (lamp.at && lamp.radius > 0) add_sphere(lamp, scene);
        scene.lamps.push_back(lamp);
    }
    scene.lamps_text = text.str();
}

}  // namespace covtrace
