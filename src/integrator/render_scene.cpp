#include "integrator/render_scene.h"

#include <utility>

namespace covtrace {

RenderScene::RenderScene(SceneDescription scene_description, const std::string& isa)
    : description(std::move(scene_description)),
      geometry(description, isa),
      textures(description),
      lights(description, geometry, &textures),
      materials(description, textures, IlluminantAdaptation(lights.total_power())),
      camera(description.camera, description.film.width, description.film.height),
      filter(description.filter) {
    geometry.set_alpha([this](TextureId id, Vec2 uv, Vec3 position) {
        return textures.eval_float(id, {uv, position});
    });
    for (const MediumDescription& m : description.media) {
        extinction.push_back(m.sigma_a);
        if (!is_black(m.sigma_s))
            description.warnings.push_back(
                {m.where, "medium \"" + m.name + "\" scatters: rendered as if it only absorbed"});
    }
    guide = CausticGuide(*this);
}

void RenderScene::prepare_spectra() {
    textures.prepare_spectra();
    lights.prepare_spectra();
}

}  // namespace covtrace
