/// Private to this folder: metallic-roughness materials and their extensions.
#pragma once

#include <map>
#include <optional>

#include "gltf/document.h"
#include "gltf/textures.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// What a material makes of a surface.
struct Surface {
    MaterialId material = -1;
    TextureId alpha = -1;
    std::optional<AreaLightDescription> emission;
    MediumId inside = -1;
    int uv_set = -1;               ///< the texture coordinates of all its textures; -1: it has none
    bool is_visible = true;        ///< false where its alpha is 0 everywhere
    bool is_strong_light = false;  ///< emits more than 1, which makes it a lamp
};

/// glTF's model is a mixture of two: metal, whose reflectance at the normal is the base colour, and
/// dielectric with a diffuse base under a specular border. docs/guide/gltf.md has all
/// substitutions.
class MaterialReader {
  public:
    MaterialReader(const Document& document, SceneDescription& scene, WarningLog& log)
        : document_(document), scene_(scene), log_(log), textures_(document, scene, log) {}

    /// materials[index], each read once; -1: glTF's default material.
    const Surface& surface(int index, const std::string& place);

  private:
    const Document& document_;
    SceneDescription& scene_;
    WarningLog& log_;
    TextureReader textures_;
    std::map<int, Surface> surfaces_;
};

}  // namespace covtrace::gltf
