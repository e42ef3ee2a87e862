/// Private to this folder: meshes that the library Draco decodes, within limits.
#pragma once

#include <draco/mesh/mesh.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/error.h"

namespace covtrace::gltf {

/// A decoded mesh, or why there is none.
struct DracoResult {
    std::unique_ptr<draco::Mesh> mesh;  ///< null where the stream can't be decoded
    std::string error;                  ///< empty where there is a mesh
    bool is_too_large = false;          ///< it would have taken more than was allowed
    uint64_t bytes = 0;                 ///< of the mesh
};

/// Decodes a stream of Draco's bitstream 2.2, which is the one that glTF knows. Its counts are held
/// against `most` bytes, and against the process's memory, before the library makes room for them;
/// points and values that it names in faces and attributes are there. Throws Error(limit) at
/// `where` where the process may not hold the mesh (core/memory_limit.h).
DracoResult decode_draco_mesh(std::span<const unsigned char> bytes, uint64_t most,
                              const SourceLocation& where);

}  // namespace covtrace::gltf
