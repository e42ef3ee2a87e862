#include "support/error_bins.h"

#include <algorithm>

namespace covtrace {

int tile_side(int width, int height) {
    return ((width + 15) / 16) * ((height + 15) / 16) < 200 ? 8 : 16;
}

std::vector<double> tile_sums(const Plane& plane, int side) {
    const int across = (plane.width + side - 1) / side, down = (plane.height + side - 1) / side;
    std::vector<double> sums(size_t(across) * size_t(down));
    for (int y = 0; y < plane.height; ++y)
        for (int x = 0; x < plane.width; ++x)
            sums[size_t(y / side * across + x / side)] += double(plane(x, y));
    return sums;
}

std::vector<ErrorTile> error_tiles(const Plane& estimated, const Plane& real, int side) {
    const std::vector<double> e = tile_sums(estimated, side), r = tile_sums(real, side),
                              n = tile_sums(Plane(real.width, real.height, 1), side);
    std::vector<ErrorTile> tiles(e.size());
    for (size_t i = 0; i < tiles.size(); ++i) tiles[i] = {e[i], r[i], n[i]};
    return tiles;
}

ErrorBins error_bins(std::vector<ErrorTile> tiles) {
    std::sort(tiles.begin(), tiles.end(),
              [](const ErrorTile& a, const ErrorTile& b) { return a.estimated < b.estimated; });
    ErrorBins result;
    for (size_t bin = 0; bin < kErrorBins; ++bin) {
        ErrorTile& sum = result.bins[bin];
        const size_t from = bin * tiles.size() / kErrorBins,
                     to = (bin + 1) * tiles.size() / kErrorBins;
        for (size_t i = from; i < to; ++i) sum += tiles[i];
        result.all += sum;
        if (sum.ratio() >= 0.7 && sum.ratio() <= 1.4) ++result.good;
    }
    return result;
}

}  // namespace covtrace
