// A measured BRDF from a file: whatever the bytes, one that can be sampled or covtrace::Error.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "bsdf/measured_brdf.h"
#include "core/error.h"
#include "pbrt/brdf_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    try {
        const covtrace::MeasuredBrdf brdf(*covtrace::read_brdf(bytes, "fuzz.bsdf", {}));
        for (int i = 0; i < 16; ++i) {
            const covtrace::Vec3 wo = covtrace::normalize({0.1f * float(i), 0.3f, 0.5f});
            const covtrace::Vec2 u{(float(i % 4) + 0.5f) / 4, (float(i / 4) + 0.5f) / 4};
            const auto s = brdf.sample(wo, u);
            if (s && !(std::abs(covtrace::length(s->wi) - 1) < 0.01f)) std::abort();
            if (s) brdf.eval(wo, s->wi);
        }
    } catch (const covtrace::Error&) {
    }
    return 0;
}
