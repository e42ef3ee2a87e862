// glTF, as text or binary, to a SceneDescription: whatever the file, a scene or covtrace::Error.
#include <string_view>

#include "fuzz/input_file.h"
#include "gltf/read_gltf.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const covtrace::InputFile text(".gltf"), binary(".glb");
    const bool is_binary =
        std::string_view(reinterpret_cast<const char*>(data), size).starts_with("glTF");
    covtrace::ReadOptions options;
    options.shutter = {0.2f, 0.7f};  // else animations would not be read
    try {
        covtrace::read_gltf((is_binary ? binary : text).write(data, size), options);
    } catch (const covtrace::Error&) {
    }
    return 0;
}
