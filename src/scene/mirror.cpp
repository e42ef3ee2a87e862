#include "scene/mirror.h"

#include "scene/pane.h"
#include "scene/smooth_surface.h"

namespace covtrace {

bool is_mirror(const SceneDescription& scene, const ShapeDescription& shape) {
    if (is_pane(scene, shape)) return true;
    if (!is_plain(scene, shape)) return false;
    const auto* metal =
        std::get_if<ConductorMaterial>(&scene.materials[static_cast<size_t>(shape.material)].value);
    return metal && is_zero(scene, metal->u_roughness) && is_zero(scene, metal->v_roughness);
}

}  // namespace covtrace
