/// Private to this folder: metallic-roughness materials and their extensions.
#pragma once

#include <map>
#include <optional>
#include <tuple>

#include "gltf/document.h"
#include "gltf/geometry.h"
#include "gltf/textures.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// The material of a surface as the scene has it, with its alpha and the medium inside.
struct Surface {
    MaterialId material = -1;
    TextureId alpha = -1;
    std::optional<AreaLightDescription> emission;
    MediumId inside = -1;
    VertexLayout layout;            ///< of the meshes that have it
    bool is_seen_from_back = true;  ///< double-sided, or a body that light passes through
    bool is_visible = true;         ///< false where alpha is 0 everywhere
    bool is_strong_light = false;   ///< emits more than 1, which makes it a lamp
};

/// glTF's model is a mixture of two: metal, whose reflectance at the normal is the base colour, and
/// dielectric with a diffuse base under a specular border. docs/guide/gltf.md has all
/// substitutions.
class MaterialReader {
  public:
    MaterialReader(const Document& document, SceneDescription& scene, WarningLog& log)
        : document_(document), scene_(scene), log_(log), textures_(document, scene, log) {}

    /// The surface that materials[index] makes with such colours of vertices, each read once; -1:
    /// glTF's default material. `is_unlit`: whether it is seen without lighting whatever the
    /// material says.
    const Surface& surface(int index, ColourUse colours, bool is_unlit, const std::string& place);

    /// Whether surfaces of materials[index] (-1: glTF's default) may be outlines of cartoons: seen
    /// from the front alone, opaque, and of one colour that is next to black.
    bool may_outline(int index) const;

  private:
    const Document& document_;
    SceneDescription& scene_;
    WarningLog& log_;
    TextureReader textures_;
    std::map<std::tuple<int, ColourUse, bool>, Surface> surfaces_;
};

}  // namespace covtrace::gltf
