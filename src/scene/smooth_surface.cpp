#include "scene/smooth_surface.h"

namespace covtrace {

bool is_zero(const SceneDescription& scene, TextureId texture) {
    if (texture < 0) return true;
    const auto* constant =
        std::get_if<ConstantTexture>(&scene.textures[static_cast<size_t>(texture)].value);
    return constant && constant->value.r == 0;
}

bool is_plain(const SceneDescription& scene, const ShapeDescription& shape) {
    if (shape.material < 0 || shape.area_light >= 0 || shape.alpha >= 0 || scene.regularizes)
        return false;
    const MaterialDescription& m = scene.materials[static_cast<size_t>(shape.material)];
    return !m.mix && !m.clearcoat && !m.sheen && m.displacement < 0 && m.normal_map < 0;
}

}  // namespace covtrace
