/// Private to this folder: the file's camera, or one that shows the whole scene.
#pragma once

#include <string>
#include <vector>

#include "gltf/document.h"
#include "gltf/nodes.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// Sets camera and film by the chosen camera: one of those that nodes place, in their order, called
/// as its node or else as itself; the first for an empty `choice`. Where there is none, by one from
/// the front, to the right and above (assets face +z), which `no_camera` tells. The lens is closed;
/// its focus lies at the depth of the scene's centre, for those who open it. `bounds`: of
/// everything that is placed. Throws Error(usage) as `chosen`.
void set_view(const Document& document, const std::vector<PlacedNode>& nodes, const Bounds3& bounds,
              const std::string& choice, SceneDescription& scene, WarningLog& log);

}  // namespace covtrace::gltf
