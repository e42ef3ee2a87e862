// Every image format that textures and environment maps may have: finite pixels or covtrace::Error.
#include <cmath>
#include <cstdlib>

#include "core/error.h"
#include "fuzz/input_file.h"
#include "image/raster.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    // The name is that of a Targa file, which counts where the first bytes say nothing else.
    static const covtrace::InputFile file(".tga");
    try {
        const covtrace::RasterImage image = covtrace::read_raster(file.write(data, size));
        const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
        if (image.size() != pixels * static_cast<size_t>(image.channels)) std::abort();
        for (const float v : image.values)
            if (!std::isfinite(v)) std::abort();
    } catch (const covtrace::Error&) {
    }
    return 0;
}
