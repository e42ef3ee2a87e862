// Small scenes given as text, rendered in the process.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>

#include "pbrt/read_scene.h"
#include "render/session.h"

namespace covtrace::test {

/// Renders a scene given as text; relative file names are looked up in `folder`.
inline RenderResult render_text(const std::string& text, const RenderOptions& options,
                                const std::filesystem::path& folder = ".") {
    RenderScene scene(read_pbrt_string(text, "test", folder));
    Monitor monitor;
    return render(scene, options, monitor);
}

inline RenderOptions uniform(double spp, uint64_t seed = 0) {
    RenderOptions o;
    o.method = Method::uniform;
    o.spp = spp;
    o.seed = seed;
    return o;
}

inline RenderOptions covariance_method(double spp, uint64_t seed = 0) {
    RenderOptions o;
    o.method = Method::covariance;
    o.spp = spp;
    o.seed = seed;
    return o;
}

struct Summary {
    double mean = 0;  ///< mean over pixels and the three channels
    double standard_error =
        0;  ///< standard error of that mean, from the variance layer (channels fully correlated)
    int nonfinite = 0;
};

inline Summary summarize_image(const Image& image) {
    Summary s;
    double variance = 0;
    const auto n = double(image.pixel_count());
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const Rgb c = image.rgb(i), v = image.rgb(i, "variance.");
        s.mean += (double(c.r) + c.g + c.b) / 3 / n;
        variance += (double(v.r) + v.g + v.b) / 3 / (n * n);
    }
    for (const Channel& c : image.channels)
        for (float v : c.values) s.nonfinite += !std::isfinite(v);
    s.standard_error = std::sqrt(variance);
    return s;
}

/// Mean of a channel over the middle of the image, from a quarter to three quarters of each side.
inline double middle_mean(const Image& image, const std::string& channel) {
    const Channel* c = image.find(channel);
    double sum = 0, n = 0;
    for (int y = image.height() / 4; y < 3 * image.height() / 4; ++y)
        for (int x = image.width() / 4; x < 3 * image.width() / 4; ++x) {
            sum += c->values[size_t(y) * size_t(image.width()) + size_t(x)];
            ++n;
        }
    return sum / n;
}

}  // namespace covtrace::test
