/// The tiles of an image, and who traces which of them.
#pragma once

#include <algorithm>
#include <cstdint>

#include "image/image.h"

namespace covtrace {

/// One of `count` equal shares of an image, by whole tiles.
struct Shard {
    int index = 0;  ///< from 0
    int count = 1;
    bool is_all() const { return count == 1; }
};

/// Tiles: squares of 16x16 pixels that cover a region row by row, those at its right and lower
/// border cut off.
class Tiles {
  public:
    explicit Tiles(const PixelBounds& region)
        : region_(region), columns_(tiles(region.width())), rows_(tiles(region.height())) {}

    int64_t count() const { return int64_t(columns_) * rows_; }
    PixelBounds bounds(int64_t tile) const {
        const int x0 = region_.x0 + column(tile) * kSize, y0 = region_.y0 + row(tile) * kSize;
        return {x0, y0, std::min(x0 + kSize, region_.x1), std::min(y0 + kSize, region_.y1)};
    }
    /// Whether a tile belongs to a shard. Shards run diagonally over the image, so that each has
    /// something of all its parts.
    bool belongs_to(int64_t tile, const Shard& shard) const {
        return owner(tile, shard.count) == shard.index;
    }
    /// Index of the shard, of `shards` in all, that a tile belongs to.
    int owner(int64_t tile, int shards) const { return (column(tile) + row(tile)) % shards; }
    /// Number of tiles in one shard.
    int64_t count(const Shard& shard) const {
        int64_t n = 0;
        for (int64_t tile = 0; tile < count(); ++tile) n += belongs_to(tile, shard);
        return n;
    }

  private:
    static constexpr int kSize = 16;
    static int tiles(int pixels) { return (pixels + kSize - 1) / kSize; }
    int column(int64_t tile) const { return int(tile % columns_); }
    int row(int64_t tile) const { return int(tile / columns_); }

    PixelBounds region_;
    int columns_, rows_;
};

}  // namespace covtrace
