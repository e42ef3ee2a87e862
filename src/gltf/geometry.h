/// Private to this folder: primitives of meshes as triangles.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "gltf/colours.h"
#include "gltf/deformation.h"
#include "gltf/document.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// The vertex data that the textures of a primitive's material read.
struct VertexLayout {
    static constexpr int kNoSet = -1;
    /// The set of texture coordinates that becomes the surface's (u, v).
    int uv_set = kNoSet;
    bool needs_uvs = false;      ///< whether a texture reads `uv_set`: else it may be missing
    std::vector<int> more_sets;  ///< the sets of TriangleMesh::more_uvs
    bool has_colours = false;
    bool needs_tangents = false;  ///< whether maps or widths are laid along the tangents
    auto operator<=>(const VertexLayout&) const = default;
};

/// Converts each primitive once per layout of its vertices; all nodes that use a mesh share it.
class GeometryReader {
  public:
    /// `mark_radii`: of points and lines, see the function of that name.
    GeometryReader(const Document& document, WarningLog& log, std::vector<float> mark_radii)
        : document_(document),
          log_(log),
          mark_radii_(std::move(mark_radii)),
          bytes_(budget_of_meshes(document.bytes)) {}

    /// The changes that COLOR_0 of meshes[mesh].primitives[primitive] makes.
    ColourUse colours(int mesh, size_t primitive);

    /// The triangles of meshes[mesh].primitives[primitive] with the texture coordinates, colours
    /// and tangents of the layout, v upwards as everywhere else here (glTF's runs down); points and
    /// lines as solids. Null for primitives without any. Throws Error(limit) where all meshes are
    /// too large for the file.
    std::shared_ptr<const TriangleMesh> mesh(int mesh, size_t primitive,
                                             const VertexLayout& layout);

    /// The primitive that `mesh` gives, which must not be null, deformed by its morph targets and
    /// joints: see `deform`.
    TriangleMesh deformed(int mesh, size_t primitive, const VertexLayout& layout,
                          std::span<const double> weights, std::span<const Matrix4> joints,
                          const std::string& place);
    bool has_joints(int mesh, size_t primitive, const VertexLayout& layout);

  private:
    struct Entry {
        std::shared_ptr<const TriangleMesh> mesh;
        size_t count = 0;                        ///< number of the file's vertices
        std::vector<uint32_t> kept;              ///< indices of those that the mesh has; empty: all
        std::optional<Deformation> deformation;  ///< set once it was asked for
    };

    Entry& entry(int mesh, size_t primitive, const VertexLayout& layout);
    const Deformation& deformation(int mesh, size_t primitive, const VertexLayout& layout);
    Entry read(const tinygltf::Primitive& primitive, const VertexLayout& layout, float mark_radius,
               const std::string& place);
    void read_vertex_values(const tinygltf::Primitive& primitive, const VertexLayout& layout,
                            TriangleMesh& mesh, const std::string& place);
    /// Takes a mesh's bytes from the budget. Errors: Error(limit) where the budget of meshes is
    /// spent.
    void spend(const TriangleMesh& mesh, size_t vertices, const std::string& place);
    void warn(const std::string& place, const std::string& text) {
        log_.add(document_.place(place), text);
    }

    const Document& document_;
    WarningLog& log_;
    const std::vector<float> mark_radii_;
    std::map<std::tuple<int, size_t, VertexLayout>, Entry> meshes_;
    std::map<int, ColourUse> colours_;  ///< by accessor
    Budget bytes_;                      ///< budget of what meshes may still take
};

}  // namespace covtrace::gltf
