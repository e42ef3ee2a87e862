/// The film: everything the samples of each pixel left behind. It is the state; images are views of
/// it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "image/image.h"

namespace covtrace {

/// Running means over a pixel's samples in index order (Welford 1962). 72 bytes.
struct FilmPixel {
    uint32_t count = 0;  ///< samples taken; the next sample has this index
    Rgb mean;            ///< of the weighted radiance: the raw pixel
    Rgb in_view;         ///< the part of it from emitters in view (PathResult::in_view)
    Rgb squares;         ///< sum of squared deviations from the mean
    Rgb albedo;
    Vec3 normal;
    float depth = 0;     ///< mean over the samples that hit something
    float coverage = 0;  ///< share of the samples that hit something

    struct Sample {
        Rgb radiance;  ///< filter weight and imaging scale applied; finite
        Rgb in_view;   ///< likewise
        Rgb albedo;
        Vec3 normal;
        float depth = 0;
        bool hit = false;
    };
    void add(const Sample& s);
    /// Variance of the mean per channel; 0 below two samples.
    Rgb variance_of_mean() const;
};

struct Film {
    explicit Film(PixelBounds region)
        : bounds(region), pixels(size_t(region.width()) * size_t(region.height())) {}
    PixelBounds bounds;
    std::vector<FilmPixel> pixels;

    /// x, y in [bounds.x0, bounds.x1) x [bounds.y0, bounds.y1).
    FilmPixel& at(int x, int y) {
        return pixels[size_t(y - bounds.y0) * size_t(bounds.width()) + size_t(x - bounds.x0)];
    }
    double mean_count() const;
};

}  // namespace covtrace
