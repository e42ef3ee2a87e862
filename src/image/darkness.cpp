#include "image/darkness.h"

#include "image/color_encoding.h"

namespace covtrace {

double dark_share(const Image& image) {
    constexpr float kBlack = 0.02f;  // albedo of surfaces that are dark in any light
    const float step = srgb_decode(1.0f / 255);
    if (!image.find("albedo.R") || !image.find("R")) return 0;
    size_t surfaces = 0, dark = 0;
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const float albedo = luminance(image.rgb(i, "albedo."));
        if (!(albedo > kBlack)) continue;
        ++surfaces;
        dark += luminance(image.rgb(i)) < step * albedo;
    }
    return surfaces == 0 ? 0 : double(dark) / double(surfaces);
}

}  // namespace covtrace
