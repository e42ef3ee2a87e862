// PLY to a mesh: whatever the bytes, a mesh whose indices are in range or covtrace::Error.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/error.h"
#include "pbrt/ply_reader.h"

namespace {

template <typename Faces>
void check(const Faces& faces, size_t vertices) {
    for (const auto& face : faces)
        for (const uint32_t corner : face)
            if (corner >= vertices) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    try {
        covtrace::WarningLog log;
        const covtrace::PlyMesh mesh = covtrace::read_ply(bytes, "fuzz.ply", log);
        if (mesh.triangles) check(mesh.triangles->triangles, mesh.triangles->positions.size());
        if (mesh.quads) check(mesh.quads->patches, mesh.quads->positions.size());
    } catch (const covtrace::Error&) {
    }
    return 0;
}
