/// Makes geometry of Shape directives.
#pragma once

#include <optional>
#include <vector>

#include "pbrt/build_context.h"
#include "pbrt/mesh_files.h"

namespace covtrace {

using ShapeGeometry = decltype(ShapeDescription::geometry);

/// Result of a Shape directive: geometry at once, or a mesh file that is read later.
struct BuiltShape {
    std::vector<ShapeGeometry> geometry;
    std::optional<size_t> mesh_file;
    int tube_sides = 0;  ///< ShapeDescription::tube_sides
};

/// Builds shapes as they are read; mesh files wait, so that they are read in parallel.
class ShapeBuilder {
  public:
    explicit ShapeBuilder(BuildContext& context) : context_(context) {}

    /// Builds a shape; its parameter "alpha" is left to the caller. Errors: Error(scene) with the
    /// place in the scene.
    BuiltShape build(Entity& entity);

    /// Reads all mesh files that shapes have named. Errors: as MeshFiles::read_all.
    void read_mesh_files() { mesh_files_.read_all(context_.files, context_.log); }
    /// Meshes of a file, after read_mesh_files: none for an empty file, two for one with triangles
    /// and quads, unless these are to be cut into triangles.
    std::vector<ShapeGeometry> mesh(size_t file, bool as_triangles) const;

  private:
    std::vector<ShapeGeometry> triangle_mesh(Entity& e);
    std::vector<ShapeGeometry> bilinear_mesh(Entity& e);
    size_t mesh_file(Entity& e);
    std::vector<ShapeGeometry> subdivided_mesh(Entity& e);
    std::vector<ShapeGeometry> cylinder(Entity& e);
    BuiltShape curve(Entity& e);
    /// Sides of the tubes that a mesh consists of, as a parameter of ours says; 0: it does not.
    static int tube_sides(Entity& e);

    BuildContext& context_;
    MeshFiles mesh_files_;
};

}  // namespace covtrace
