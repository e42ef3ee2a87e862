/// A grid over the colours of the unit cube, for tables of functions of a reflectance.
#pragma once

#include <array>
#include <cstddef>

#include "core/vec.h"

namespace covtrace {

/// A colour with channels cut to [0, 1]; NaN becomes 0.
Rgb clamp_to_unit(Rgb c);

inline bool is_grey(Rgb c) {
    return c.r == c.g && c.g == c.b;
}

/// Nodes per axis. They crowd towards black and white, where the tabulated functions depend only on
/// ratios: of the channels, or of what the channels lack to 1.
constexpr int kColourNodes = 25;
constexpr size_t kColourGridSize = size_t{kColourNodes} * kColourNodes * kColourNodes;

/// The colour of a node, from 0 to kColourGridSize - 1; blue fastest.
Rgb colour_of_node(size_t node);

/// Nodes around a colour and their weights, which sum to 1.
struct ColourCell {
    std::array<size_t, 4> nodes{};
    std::array<float, 4> weights{};
};
/// The cell of a colour in the unit cube. Interpolation is linear in each of six tetrahedra that
/// share the diagonal of a cell, so that between greys all weight lies on greys.
ColourCell colour_cell(Rgb colour);

}  // namespace covtrace
