/// Geometry out of Shape directives.
#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "scene/build_context.h"
#include "scene/ply_reader.h"

namespace covtrace {

using ShapeGeometry = decltype(ShapeDescription::geometry);

/// Builds shapes as they are read, and keeps mesh files, so that each is read once.
class ShapeBuilder {
  public:
    explicit ShapeBuilder(BuildContext& context) : context_(context) {}

    /// None for an empty mesh (with a warning), two for a file with triangles and quads. What the
    /// file calls "alpha" is left to the caller. Errors: Error(scene) with the place in the scene
    /// or mesh file.
    std::vector<ShapeGeometry> build(Entity& entity);

  private:
    std::vector<ShapeGeometry> triangle_mesh(Entity& e);
    std::vector<ShapeGeometry> bilinear_mesh(Entity& e);
    std::vector<ShapeGeometry> mesh_file(Entity& e);
    std::vector<ShapeGeometry> subdivided_mesh(Entity& e);
    std::vector<ShapeGeometry> cylinder(Entity& e);
    std::vector<ShapeGeometry> curve(Entity& e);

    BuildContext& context_;
    std::map<std::filesystem::path, PlyMesh> mesh_files_;
};

}  // namespace covtrace
