#include "integrator/render_scene.h"

#include <utility>

namespace covtrace {

RenderScene::RenderScene(SceneDescription scene_description, const std::string& isa)
    : description(std::move(scene_description)),
      geometry(description, isa),
      lights(description, geometry),
      textures(description),
      materials(description, textures, IlluminantAdaptation(lights.total_power())),
      camera(description.camera, description.film.width, description.film.height),
      filter(description.filter) {
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
