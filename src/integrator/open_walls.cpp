#include "integrator/open_walls.h"

#include <algorithm>
#include <string>
#include <vector>

#include "integrator/view_probe.h"

namespace covtrace {

bool open_walls(SceneDescription& scene, const Geometry& geometry, const TextureStore& textures) {
    // Media without a wall around them would keep all light off a camera within
    if (!scene.is_lit_from_outside || scene.camera.medium >= 0) return false;
    const ViewProbe probe(scene, geometry, textures);
    if (!probe.is_dark()) return false;
    const std::vector<bool> walls = probe.outer_walls();
    if (probe.is_dark(walls)) return false;
    size_t next = 0;  // place of a shape in Geometry::shapes
    const auto open = [&](std::vector<ShapeDescription>& shapes) {
        for (ShapeDescription& shape : shapes)
            if (walls[next++]) shape.visible_to &= set_of(RayKind::any) | set_of(RayKind::camera);
    };
    open(scene.shapes);
    for (ObjectDescription& object : scene.objects) open(object.shapes);
    scene.warnings.push_back(
        {{},
         "walls keep the light from outside from most of what is seen; the outermost (" +
             std::to_string(std::count(walls.begin(), walls.end(), true)) + " of " +
             std::to_string(walls.size()) +
             " shapes) let it in, as in viewers, and throw no shadows; a lamp at the camera takes "
             "its place by the option light: \"camera\""});
    return true;
}

}  // namespace covtrace
