#include "scene/vertex_colours.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace covtrace {
namespace {

/// An index for each vertex that is the same for all vertices in one place.
std::vector<uint32_t> places(const std::vector<Vec3>& positions) {
    std::vector<uint32_t> order(positions.size()), place(positions.size());
    std::iota(order.begin(), order.end(), 0);
    const auto key = [&](uint32_t i) {
        const Vec3& p = positions[i];
        return std::array{p.x, p.y, p.z};
    };
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    for (size_t i = 0; i < order.size(); ++i)
        place[order[i]] =
            i > 0 && key(order[i]) == key(order[i - 1]) ? place[order[i - 1]] : order[i];
    return place;
}

/// One side of a triangle, from the lower to the higher place.
struct Side {
    std::array<uint32_t, 2> places;
    std::array<uint32_t, 2> vertices;
    uint32_t triangle;
    uint8_t corner;  ///< opposite of it
};

/// Smallest and largest values of colours, channel by channel.
struct Range {
    std::array<float, 4> least{kInfinity, kInfinity, kInfinity, kInfinity};
    std::array<float, 4> most{-kInfinity, -kInfinity, -kInfinity, -kInfinity};

    void extend(const VertexColour& c) {
        const std::array<float, 4> channels{c.value.r, c.value.g, c.value.b, c.alpha};
        for (size_t i = 0; i < 4; ++i) {
            least[i] = std::min(least[i], channels[i]);
            most[i] = std::max(most[i], channels[i]);
        }
    }
    /// Contrast of the range, in [0, 1]: half of the difference over the mean, of the luminance or
    /// of alpha, whichever is the larger one.
    float contrast() const {
        const auto quotient = [](float a, float b) { return a + b > 0 ? (b - a) / (a + b) : 0; };
        const float colour = quotient(luminance({least[0], least[1], least[2]}),
                                      luminance({most[0], most[1], most[2]}));
        return std::clamp(std::max(colour, quotient(least[3], most[3])), 0.0f, 1.0f);
    }
};

}  // namespace

void find_colour_steps(TriangleMesh& mesh) {
    mesh.colour_steps.assign(mesh.triangles.size(), {0, 0, 0});
    const std::vector<uint32_t> place = places(mesh.positions);
    std::vector<Side> sides;
    sides.reserve(3 * mesh.triangles.size());
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (uint8_t corner = 0; corner < 3; ++corner) {
            uint32_t a = mesh.triangles[t][(corner + 1) % 3],
                     b = mesh.triangles[t][(corner + 2) % 3];
            if (place[a] > place[b]) std::swap(a, b);
            sides.push_back({{place[a], place[b]}, {a, b}, t, corner});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return a.places != b.places ? a.places < b.places : a.triangle < b.triangle;
    });
    for (size_t first = 0, end = 0; first < sides.size(); first = end) {
        std::array<Range, 2> ends;
        for (end = first; end < sides.size() && sides[end].places == sides[first].places; ++end)
            for (size_t k = 0; k < 2; ++k) ends[k].extend(mesh.colours[sides[end].vertices[k]]);
        const float contrast = std::max(ends[0].contrast(), ends[1].contrast());
        const auto step =
            static_cast<uint8_t>(std::lround(TriangleMesh::kLargestColourStep * contrast));
        for (size_t i = first; i < end; ++i)
            mesh.colour_steps[sides[i].triangle][sides[i].corner] = step;
    }
}

}  // namespace covtrace
