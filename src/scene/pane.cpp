#include "scene/pane.h"

#include "scene/smooth_surface.h"

namespace covtrace {

bool is_pane(const SceneDescription& scene, const ShapeDescription& shape) {
    if (!is_plain(scene, shape)) return false;
    const auto& material = scene.materials[static_cast<size_t>(shape.material)].value;
    if (const auto* thin = std::get_if<ThinDielectricMaterial>(&material))
        return is_zero(scene, thin->u_roughness) && is_zero(scene, thin->v_roughness);
    const auto* glass = std::get_if<DielectricMaterial>(&material);
    return glass && !glass->dispersion && is_zero(scene, glass->u_roughness) &&
           is_zero(scene, glass->v_roughness);
}

}  // namespace covtrace
