#include "integrator/render_scene.h"

#include <utility>

namespace covtrace {

RenderScene::RenderScene(SceneDescription scene_description, const std::string& isa,
                         size_t texture_bytes)
    : LitScene(std::move(scene_description), isa, texture_bytes),
      guide(static_cast<const LitScene&>(*this)),
      sky_guide(static_cast<const LitScene&>(*this)) {}

std::map<std::string, size_t> RenderScene::memory() const {
    std::map<std::string, size_t> bytes = LitScene::memory();
    bytes["guide"] = sky_guide.memory();
    return bytes;
}

}  // namespace covtrace
