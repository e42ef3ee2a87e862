/// The pixels of an image in ten groups by brightness, so that measures per group show errors in
/// the dark.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/plane.h"

namespace covtrace {

constexpr size_t kDeciles = 10;
/// Side, in pixels, of the blocks that are sorted: single pixels would be told apart by their
/// noise.
constexpr int kDecileBlock = 8;
constexpr uint8_t kNoDecile = 255;

/// The decile of every pixel, row by row: 0 the darkest, 9 the brightest.
///
/// The image is cut into blocks of 8 x 8 pixels from its top left corner, smaller ones at the right
/// and bottom border. The n blocks are sorted by the mean luminance of their pixels, equal ones by
/// position; decile k has those from floor(k n / 10) to floor((k + 1) n / 10), so that fewer than
/// ten blocks leave deciles empty. Pixels whose luminance is not finite belong to none (kNoDecile),
/// and blocks of nothing else do not count.
std::vector<uint8_t> brightness_deciles(const Plane& luminance);

}  // namespace covtrace
