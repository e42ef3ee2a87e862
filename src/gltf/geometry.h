/// Private to this folder: primitives of meshes as triangles.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "gltf/deformation.h"
#include "gltf/document.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// Converts each primitive once per set of texture coordinates; all nodes that use a mesh share it.
class GeometryReader {
  public:
    GeometryReader(const Document& document, WarningLog& log)
        : document_(document), log_(log), bytes_(budget_of_meshes(document.bytes)) {}

    /// The triangles of meshes[mesh].primitives[primitive] with TEXCOORD_`uv_set` (-1: the first
    /// one, if it is there), v upwards as everywhere else here (glTF's runs down). Null for points,
    /// lines and primitives without triangles, with a warning where something is left out. Throws
    /// Error(limit) where all meshes are too large for the file.
    std::shared_ptr<const TriangleMesh> mesh(int mesh, size_t primitive, int uv_set);

    /// The primitive that `mesh` gives, which must not be null, deformed by its morph targets and
    /// joints: see `deform`.
    TriangleMesh deformed(int mesh, size_t primitive, int uv_set, std::span<const double> weights,
                          std::span<const Matrix4> joints, const std::string& place);
    bool has_joints(int mesh, size_t primitive, int uv_set);

  private:
    struct Entry {
        std::shared_ptr<const TriangleMesh> mesh;
        size_t count = 0;                        ///< number of the file's vertices
        std::vector<uint32_t> kept;              ///< indices of those that the mesh has; empty: all
        std::optional<Deformation> deformation;  ///< set once it was asked for
    };

    Entry& entry(int mesh, size_t primitive, int uv_set);
    const Deformation& deformation(int mesh, size_t primitive, int uv_set);
    Entry read(const tinygltf::Primitive& primitive, int uv_set, const std::string& place);
    /// Takes a mesh's bytes from the budget. Errors: Error(limit) where the budget of meshes is
    /// spent.
    void spend(size_t vertices, size_t triangles, const std::string& place);
    void warn(const std::string& place, const std::string& text) {
        log_.add(document_.place(place), text);
    }

    const Document& document_;
    WarningLog& log_;
    std::map<std::tuple<int, size_t, int>, Entry> meshes_;
    Budget bytes_;  ///< budget of what meshes may still take
};

}  // namespace covtrace::gltf
