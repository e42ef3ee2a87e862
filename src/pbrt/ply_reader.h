/// Meshes in Stanford's PLY format: ascii, binary little and big endian.
///
/// The reader takes the vertex properties x y z, nx ny nz and one of the pairs u v, s t, texture_u
/// texture_v, texture_s texture_t, and the faces' vertex_indices (or vertex_index), of any number
/// type; all else is skipped.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "scene/scene_description.h"
#include "scene/warning_log.h"

namespace covtrace {

/// The mesh of a file in two parts, each null where there are no such faces.
struct PlyMesh {
    std::shared_ptr<const TriangleMesh> triangles;
    std::shared_ptr<const BilinearMesh> quads;  ///< corners reordered: 0, 1, 3, 2 of the file
};

/// Both parts as one mesh, each quad cut into two triangles that share their vertices with all
/// others.
std::shared_ptr<const TriangleMesh> triangles_of(const PlyMesh& mesh);

/// Reads a mesh. Faces with more than four corners are cut into fans, those with fewer than three
/// are left out, each with a warning. Errors: Error(scene) that names `file` and, for ascii, the
/// line: broken headers, missing properties, truncation, counts that can't be in the file, indices
/// out of range, numbers that aren't finite.
PlyMesh read_ply(std::string_view bytes, const std::string& file, WarningLog& log);

}  // namespace covtrace
