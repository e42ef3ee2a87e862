/// Private to this folder: primitives of meshes as triangles.
#pragma once

#include <map>
#include <memory>
#include <tuple>

#include "gltf/document.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// Converts each primitive once per set of texture coordinates; meshes are shared by what uses
/// them.
class GeometryReader {
  public:
    GeometryReader(const Document& document, WarningLog& log)
        : document_(document), log_(log), bytes_(budget_of_meshes(document.bytes)) {}

    /// The triangles of meshes[mesh].primitives[primitive] with TEXCOORD_`uv_set` (-1: the first
    /// one, if it is there), v upwards as everywhere else here (glTF's runs down). Null for points,
    /// lines and primitives without triangles, with a warning where something is left out. Throws
    /// Error(limit) where all meshes are too large for the file.
    std::shared_ptr<const TriangleMesh> mesh(int mesh, size_t primitive, int uv_set);

  private:
    std::shared_ptr<const TriangleMesh> read(const tinygltf::Primitive& primitive, int uv_set,
                                             const std::string& place);
    void warn(const std::string& place, const std::string& text) {
        log_.add(document_.place(place), text);
    }

    const Document& document_;
    WarningLog& log_;
    std::map<std::tuple<int, size_t, int>, std::shared_ptr<const TriangleMesh>> meshes_;
    Budget bytes_;  ///< that meshes may still take
};

}  // namespace covtrace::gltf
