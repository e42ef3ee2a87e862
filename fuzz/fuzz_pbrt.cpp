// pbrt-v4 text to a SceneDescription: whatever the text, a scene or covtrace::Error.
#include <cstdint>
#include <string_view>

#include "pbrt/read_scene.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        covtrace::read_pbrt_string(text, "fuzz.pbrt", "/nonexistent");
    } catch (const covtrace::Error&) {
    }
    return 0;
}
