#include "image/brightness_deciles.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

namespace {

struct Block {
    size_t place;  ///< index of the block, row by row
    double sum = 0;
    int pixels = 0;
    double mean() const { return sum / pixels; }
};

}  // namespace

std::vector<uint8_t> brightness_deciles(const Plane& luminance) {
    const auto blocks_along = [](int pixels) {
        return size_t((pixels + kDecileBlock - 1) / kDecileBlock);
    };
    const size_t across = blocks_along(luminance.width), down = blocks_along(luminance.height);
    const auto place = [&](size_t pixel) {
        const auto width = size_t(luminance.width), side = size_t(kDecileBlock);
        return pixel / width / side * across + pixel % width / side;
    };

    std::vector<Block> blocks(across * down);
    for (size_t i = 0; i < blocks.size(); ++i) blocks[i].place = i;
    for (size_t i = 0; i < luminance.size(); ++i) {
        if (!std::isfinite(luminance[i])) continue;
        Block& block = blocks[place(i)];
        block.sum += double(luminance[i]);
        ++block.pixels;
    }
    std::erase_if(blocks, [](const Block& b) { return b.pixels == 0; });
    std::stable_sort(blocks.begin(), blocks.end(),
                     [](const Block& a, const Block& b) { return a.mean() < b.mean(); });

    std::vector<uint8_t> decile_of_block(across * down, kNoDecile);
    for (size_t decile = 0; decile < kDeciles; ++decile) {
        const size_t from = decile * blocks.size() / kDeciles,
                     to = (decile + 1) * blocks.size() / kDeciles;
        for (size_t i = from; i < to; ++i) decile_of_block[blocks[i].place] = uint8_t(decile);
    }
    std::vector<uint8_t> deciles(luminance.size(), kNoDecile);
    for (size_t i = 0; i < deciles.size(); ++i)
        if (std::isfinite(luminance[i])) deciles[i] = decile_of_block[place(i)];
    return deciles;
}

}  // namespace covtrace
