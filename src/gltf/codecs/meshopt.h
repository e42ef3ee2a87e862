/// Private to this folder: buffer views that EXT_meshopt_compression holds.
#pragma once

#include "gltf/document.h"

namespace covtrace::gltf {

/// Decodes the buffer views with EXT_meshopt_compression or KHR_meshopt_compression: each then lies
/// in a buffer of its own. Where the library is too old for a stream, the uncompressed bytes count
/// if the file has them. Refuses, at the buffer view, what can't be decoded; throws Error(limit)
/// where the file decodes to too much.
void decode_meshopt(Document& document);

}  // namespace covtrace::gltf
