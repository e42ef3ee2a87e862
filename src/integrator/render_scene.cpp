#include "integrator/render_scene.h"

#include <utility>

namespace covtrace {

RenderScene::RenderScene(SceneDescription scene_description, const std::string& isa,
                         size_t texture_bytes)
    : LitScene(std::move(scene_description), isa, texture_bytes),
      guide(static_cast<const LitScene&>(*this)) {}

}  // namespace covtrace
