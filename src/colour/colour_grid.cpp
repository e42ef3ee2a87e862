#include "colour/colour_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/fast_math.h"

namespace covtrace {
namespace {

constexpr int kCells = kColourNodes - 1;
/// Steps along red, green and blue from node to node, as differences of node numbers.
constexpr std::array<size_t, 3> kStrides{kColourNodes * kColourNodes, kColourNodes, 1};

float value_at(size_t i) {
    return sqr(std::sin(0.5f * kPi * static_cast<float>(i) / kCells));
}
/// Position of a value among the nodes of an axis: the inverse of value_at().
float position_of(float value) {
    return arctangent(std::sqrt(value), std::sqrt(1 - value)) * (2 * kInvPi * kCells);
}

}  // namespace

Rgb clamp_to_unit(Rgb c) {
    return {std::min(std::max(0.0f, c.r), 1.0f), std::min(std::max(0.0f, c.g), 1.0f),
            std::min(std::max(0.0f, c.b), 1.0f)};
}

Rgb colour_of_node(size_t node) {
    return {value_at(node / kStrides[0]), value_at(node / kStrides[1] % kColourNodes),
            value_at(node % kColourNodes)};
}

ColourCell colour_cell(Rgb colour) {
    size_t node = 0;
    std::array<float, 3> rest{};
    for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<size_t>(c);
        const float x = position_of(colour[c]);
        const int corner = std::min(static_cast<int>(x), kCells - 1);
        rest[i] = x - static_cast<float>(corner);
        node += static_cast<size_t>(corner) * kStrides[i];
    }
    // Walk along the corners of the tetrahedron that holds the colour: from the cell's first corner
    // to its last, one channel after the other, the one with the largest rest first.
    std::array<size_t, 3> order{0, 1, 2};
    if (rest[order[0]] < rest[order[1]]) std::swap(order[0], order[1]);
    if (rest[order[1]] < rest[order[2]]) std::swap(order[1], order[2]);
    if (rest[order[0]] < rest[order[1]]) std::swap(order[0], order[1]);
    ColourCell cell;
    float left = 1;
    for (size_t i = 0; i < 3; ++i) {
        cell.nodes[i] = node;
        cell.weights[i] = left - rest[order[i]];
        left = rest[order[i]];
        node += kStrides[order[i]];
    }
    cell.nodes[3] = node;
    cell.weights[3] = left;
    return cell;
}

}  // namespace covtrace
