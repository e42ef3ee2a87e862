#include "integrator/glow_alone.h"

#include "integrator/view_probe.h"
#include "light/lights.h"
#include "scene/defaults.h"

namespace covtrace {

void light_glow_alone(SceneDescription& scene, const Geometry& geometry,
                      const TextureStore& textures) {
    if (!scene.glow_alone) return;
    if (ViewProbe(scene, geometry, textures).is_dark(Lights(scene, geometry, &textures))) {
        add_default_lights(scene, scene.glow_alone->where);
        scene.warnings.push_back(*scene.glow_alone);
    }
    scene.glow_alone.reset();
}

}  // namespace covtrace
