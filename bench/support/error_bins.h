/// Estimated errors beside measured ones, in sums over the tiles of images.
#pragma once

#include <array>
#include <vector>

#include "core/plane.h"

namespace covtrace {

/// Sums of squared errors over the pixels of a tile.
struct ErrorTile {
    double estimated = 0, real = 0;
    double pixels = 0;
    void operator+=(const ErrorTile& t) {
        estimated += t.estimated;
        real += t.real;
        pixels += t.pixels;
    }
    /// True over estimated.
    double ratio() const { return real / estimated; }
};

/// The side of a tile: 16 pixels; 8 where that makes fewer than 200 tiles of an image.
int tile_side(int width, int height);

/// The sums of a plane's tiles of `side` pixels, row by row.
std::vector<double> tile_sums(const Plane& plane, int side);

/// The tiles of one image from its planes of squared errors.
std::vector<ErrorTile> error_tiles(const Plane& estimated, const Plane& real, int side);

constexpr size_t kErrorBins = 20;
struct ErrorBins {
    std::array<ErrorTile, kErrorBins> bins;  ///< equally many tiles each, rising by the estimate
    ErrorTile all;
    int good = 0;  ///< bins whose ratio lies between 0.7 and 1.4
};
ErrorBins error_bins(std::vector<ErrorTile> tiles);

}  // namespace covtrace
