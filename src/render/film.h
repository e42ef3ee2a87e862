/// The film: everything the samples of each pixel left behind. The film is the state; images are
/// views of it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "image/image.h"
#include "integrator/path.h"
#include "render/first_surface.h"

namespace covtrace {

/// One sample, as it is added to its pixel.
struct FilmSample {
    uint32_t rays = 0;  ///< rays traced for the sample, shadow rays included: its cost
    Rgb radiance;       ///< imaging scale applied; finite
    Rgb in_view;        ///< part of the radiance from emitters in view (PathResult::in_view)
    float weight = 1;   ///< weight of the pixel filter: 1, or of either sign with expectation 1
    Rgb albedo;
    Vec3 normal;
    float depth = 0;
    bool hit = false;
    float opacity = 0;  ///< PathResult::opacity, where FilmParts::opacity asks for it
    PathFeatures features;
    FirstSurface surface;  ///< where FilmParts::surfaces asks for it
};

/// Running means over a pixel's samples in index order (Welford 1962). 60 bytes.
///
/// The pixel's colour is the mean of m + w (L - m): L a sample's radiance, w its filter weight and
/// m the mean of the samples before it. m is independent of the sample and E[w] = 1, so that this
/// has the expectation of w L, but a constant image stays constant whatever the weights sum up to,
/// as with pbrt's sum of w L over sum of w, and nothing is divided by sums that may vanish. The
/// first sample has no m and counts as it is: of its lobes' part of the image 1/n is missing.
struct FilmPixel {
    uint32_t count = 0;  ///< samples taken; the next sample has this index
    Rgb mean;            ///< mean of the weighted radiance: the raw pixel
    Rgb squares;         ///< sum of squared deviations from the mean
    Rgb albedo;
    Vec3 normal;
    float depth = 0;     ///< mean over the samples that hit something
    float coverage = 0;  ///< share of the samples that hit something

    void add(const FilmSample& s);
    /// Variance of the mean per channel; 0 below two samples.
    Rgb variance_of_mean() const;
};

/// Sums of squared deviations of the features from their means. 20 bytes.
struct FeatureSquares {
    Rgb albedo;
    float normal = 0;  ///< the three components together
    float depth = 0;
};

/// Records that a film keeps beside its pixels.
struct FilmParts {
    bool in_view = false;   ///< the light of emitters in view
    bool features = false;  ///< means and deviations of the features, and the rays
    bool surfaces = false;  ///< the first surfaces
    bool opacity = false;   ///< the opacity, where it is not FilmPixel::coverage
    bool operator==(const FilmParts&) const = default;
};

struct Film {
    explicit Film(PixelBounds region, FilmParts parts = {})
        : bounds(region), pixels(size_t(region.width()) * size_t(region.height())) {
        if (parts.in_view) in_view.resize(pixels.size());
        if (parts.features) {
            features.resize(pixels.size());
            feature_squares.resize(pixels.size());
            rays.resize(pixels.size());
        }
        if (parts.surfaces) surfaces.resize(pixels.size());
        if (parts.opacity) opacity.resize(pixels.size());
    }
    PixelBounds bounds;
    std::vector<FilmPixel> pixels;
    // Each of the following arrays is as long as `pixels`, or empty.
    std::vector<Rgb> in_view;  ///< mean of FilmSample::in_view
    /// Means; the depth's is over the samples that hit something.
    std::vector<PathFeatures> features;
    std::vector<FeatureSquares> feature_squares;
    std::vector<uint32_t> rays;          ///< rays of all samples of a pixel
    std::vector<FirstSurface> surfaces;  ///< means over the samples that hit something
    std::vector<float> opacity;          ///< mean of FilmSample::opacity

    /// Index of the pixel (x, y), in [bounds.x0, bounds.x1) x [bounds.y0, bounds.y1), in `pixels`.
    size_t index(int x, int y) const {
        return size_t(y - bounds.y0) * size_t(bounds.width()) + size_t(x - bounds.x0);
    }
    /// Adds the next sample of pixel i.
    void add(size_t i, const FilmSample& sample);
    double mean_count() const;
    size_t memory() const {  ///< bytes
        return pixels.size() * sizeof(FilmPixel) + in_view.size() * sizeof(Rgb) +
               features.size() * sizeof(PathFeatures) +
               feature_squares.size() * sizeof(FeatureSquares) + rays.size() * sizeof(uint32_t) +
               surfaces.size() * sizeof(FirstSurface) + opacity.size() * sizeof(float);
    }
};

}  // namespace covtrace
