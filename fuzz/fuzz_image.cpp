// Every image format that textures and environment maps may have: finite pixels or covtrace::Error.
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "image/raster.h"

namespace {

/// Readers want a file. Its name says Targa, which counts where the first bytes say nothing else.
const std::filesystem::path& input_file() {
    struct Removed {
        std::filesystem::path path = std::filesystem::temp_directory_path() /
                                     ("covtrace-fuzz-" + std::to_string(getpid()) + ".tga");
        ~Removed() { std::filesystem::remove(path); }
    };
    static const Removed file;
    return file.path;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    std::ofstream(input_file(), std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    try {
        const covtrace::RasterImage image = covtrace::read_raster(input_file());
        const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
        if (image.values.size() != pixels * static_cast<size_t>(image.channels)) std::abort();
        for (const float v : image.values)
            if (!std::isfinite(v)) std::abort();
    } catch (const covtrace::Error&) {
    }
    return 0;
}
