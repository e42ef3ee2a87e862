/// Triangles of a mesh that lie on each other with opposite fronts.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "scene/scene_description.h"

namespace covtrace {

/// Which triangles of a mesh have the same corners as another one in the opposite order. So files
/// make surfaces of two sides from triangles that are seen from their fronts alone. A ray meets
/// either of the two by chance.
class OppositeTriangles {
  public:
    /// The pairs of `mesh`, null where there are none.
    static std::shared_ptr<const OppositeTriangles> of(const TriangleMesh& mesh);

    /// The triangle that lies on `primitive` and the same place in it, in Embree's barycentric
    /// coordinates; what is given where there is none.
    std::pair<uint32_t, Vec2> at(const TriangleMesh& mesh, uint32_t primitive,
                                 Vec2 barycentric) const;

  private:
    std::vector<uint32_t> opposite_;  ///< of each triangle; itself where there is none
};

}  // namespace covtrace
