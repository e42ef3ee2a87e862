#include "scene/pane.h"

namespace covtrace {

namespace {

/// Whether a texture is 0 everywhere; none is.
bool is_zero(const SceneDescription& scene, TextureId texture) {
    if (texture < 0) return true;
    const auto* constant =
        std::get_if<ConstantTexture>(&scene.textures[static_cast<size_t>(texture)].value);
    return constant && constant->value.r == 0;
}

}  // namespace

bool is_pane(const SceneDescription& scene, const ShapeDescription& shape) {
    if (shape.material < 0 || shape.area_light >= 0 || shape.alpha >= 0 || scene.regularizes)
        return false;
    const MaterialDescription& m = scene.materials[static_cast<size_t>(shape.material)];
    if (m.mix || m.clearcoat || m.sheen || m.displacement >= 0 || m.normal_map >= 0) return false;
    if (std::holds_alternative<ThinDielectricMaterial>(m.value)) return true;
    const auto* glass = std::get_if<DielectricMaterial>(&m.value);
    return glass && !glass->dispersion && is_zero(scene, glass->u_roughness) &&
           is_zero(scene, glass->v_roughness);
}

}  // namespace covtrace
