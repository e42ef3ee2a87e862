// A lens from a file: whatever the bytes, one that focuses or covtrace::Error.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "camera/exit_pupil.h"
#include "camera/lens_system.h"
#include "core/error.h"
#include "pbrt/lens_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    try {
        covtrace::LensDescription lens;
        lens.surfaces = covtrace::read_lens(bytes, "fuzz.dat", {});
        if (lens.surfaces.size() > 16) return 0;  // no more is found in longer ones, only later
        const covtrace::LensSystem system(lens, 1e-3f, 10, {});
        if (!(system.image_distance() > 0)) std::abort();
        const covtrace::ExitPupils pupils(system, 0.02f);
        for (int i = 0; i < 16; ++i) {
            const covtrace::Vec2 film{0.001f * float(i), 0.0007f * float(i)};
            const auto pupil = pupils.sample(film, {0.3f, 0.06f * float(i)});
            if (!(pupil.area >= 0)) std::abort();
            if (const auto ray = system.trace(film, pupil.rear))
                if (!(std::abs(covtrace::length(ray->direction) - 1) < 0.01f)) std::abort();
        }
    } catch (const covtrace::Error&) {
    }
    return 0;
}
