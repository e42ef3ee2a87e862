/// Private to this folder: primitives that KHR_draco_mesh_compression holds.
#pragma once

#include "gltf/document.h"

namespace covtrace::gltf {

/// Decodes the primitives with KHR_draco_mesh_compression: each gets accessors of its own for its
/// indices and for the attributes that the extension names, so that all that reads accessors reads
/// them like others. Warns where a file says another number of vertices than it holds. Refuses, at
/// the primitive, streams that can't be decoded; throws Error(limit) where the file decodes to too
/// much.
void decode_draco(Document& document, WarningLog& log);

}  // namespace covtrace::gltf
