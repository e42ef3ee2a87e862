#include "texture/graph.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/noise.h"
#include "texture/mapping.h"

namespace covtrace {
namespace {

/// Parity of the cell that holds `v`: 1 where its coordinate is odd, else 0; exact for coordinates
/// of any size.
int odd(float v) {
    const float cell = std::floor(v);
    return cell - 2 * std::floor(0.5f * cell) == 1 ? 1 : 0;
}

/// pbrt-v4's colours of marble along its veins, a period of 2 pi.
Rgb marble_colour(float along) {
    constexpr std::array<Rgb, 9> kColours{
        Rgb(0.58f, 0.58f, 0.6f), Rgb(0.58f, 0.58f, 0.6f), Rgb(0.58f, 0.58f, 0.6f),
        Rgb(0.5f, 0.5f, 0.5f),   Rgb(0.6f, 0.59f, 0.58f), Rgb(0.58f, 0.58f, 0.6f),
        Rgb(0.58f, 0.58f, 0.6f), Rgb(0.2f, 0.2f, 0.33f),  Rgb(0.58f, 0.58f, 0.6f)};
    constexpr int kSegments = static_cast<int>(kColours.size()) - 3;
    const float t = std::isfinite(along) ? (0.5f + 0.5f * std::sin(along)) * kSegments : 0.0f;
    const int first = std::clamp(static_cast<int>(t), 0, kSegments - 1);
    // A cubic Bezier curve of four colours in a row: neighbours don't meet, as in pbrt-v4.
    const float b = t - static_cast<float>(first), a = 1 - b;
    const Rgb* c = &kColours[static_cast<size_t>(first)];
    return 1.5f *
           (a * a * a * c[0] + 3 * a * a * b * c[1] + 3 * a * b * b * c[2] + b * b * b * c[3]);
}

struct Evaluator {
    const TextureGraph& graph;
    const TexturePoint& at;

    Rgb operator()(const ConstantNode& node) const { return node.value; }
    Rgb operator()(const ImageNode& node) const {
        const TextureImage& image = graph.images[size_t(node.image)];
        const Vec2 st = flip_t(map_to_st(node.mapping, at));
        const ImageFootprint area = image_footprint(node.mapping, at);
        const Rgb decoded =
            node.is_spectrum
                ? image.color(st, node.filter, area, node.anisotropy)
                : Rgb(image.value(st, node.filter, area, node.anisotropy, node.channel));
        return image_value(node, decoded);
    }
    Rgb operator()(const CheckerboardNode& node) const {
        return eval(graph, active_texture(node, at), at);
    }
    Rgb operator()(const AsideTexture& node) const {
        // A point without a normal gets one half, the mean over all directions.
        if (at.normal == Vec3{}) return Rgb(0.5f);
        return Rgb(1 - std::min(1.0f, std::abs(dot(at.normal, node.direction))));
    }
    Rgb operator()(const DotsTexture& node) const {
        return eval(graph, active_texture(node, at), at);
    }
    Rgb operator()(const BilerpTexture& node) const {
        return bilerp(node, map_to_st(node.mapping, at));
    }
    Rgb operator()(const NoiseTexture& node) const {
        const Vec3 p = node.texture_from_world.point(at.position);
        const float pixel = std::max(length(node.texture_from_world.vector(at.footprint.dp[0])),
                                     length(node.texture_from_world.vector(at.footprint.dp[1])));
        const Octaves octaves{node.octaves, node.omega};
        switch (node.kind) {
            case NoiseTexture::Kind::fbm:
                return grey(fractal_noise(p, pixel, octaves));
            case NoiseTexture::Kind::wrinkled:
                return grey(turbulence(p, pixel, octaves));
            case NoiseTexture::Kind::windy:
                return grey(std::abs(fractal_noise(0.1f * p, 0.1f * pixel, {3, 0.5f})) *
                            fractal_noise(p, pixel, {6, 0.5f}));
            default: {
                const float bent =
                    fractal_noise(node.scale * p, std::abs(node.scale) * pixel, octaves);
                return marble_colour(node.scale * p.y + node.variation * bent);
            }
        }
    }
    Rgb operator()(const VertexColourTexture& node) const {
        return vertex_colour(node, at.vertices);
    }
    Rgb operator()(const CutoffTexture& node) const {
        return Rgb(eval(graph, node.tex, at).r >= node.cutoff ? 1.0f : 0.0f);
    }
    Rgb operator()(const FacingNode& node) const {
        if (at.facing == kSeenFromNowhere) {
            Rgb sum;
            for (size_t i = 0; i < node.mean_shares.size(); ++i)
                sum += node.mean_shares[i] * eval(graph, node.between.textures[i], at);
            return sum;
        }
        const FacingNeighbours n = facing_neighbours(node.between, at.facing);
        const Rgb first = eval(graph, n.first, at);
        return n.share > 0 ? lerp(n.share, first, eval(graph, n.second, at)) : first;
    }
    /// Non-finite values, which parameters near the largest numbers there are give, become 0.
    static Rgb grey(float value) { return Rgb(std::isfinite(value) ? value : 0.0f); }
    Rgb operator()(const ScaleNode& node) const {
        const Rgb scale = eval(graph, node.scale, at);
        return is_black(scale) ? Rgb{} : scale * eval(graph, node.tex, at);
    }
    Rgb operator()(const MixNode& node) const {
        const Rgb amount = eval(graph, node.amount, at);
        if (amount == Rgb(0)) return eval(graph, node.tex1, at);
        if (amount == Rgb(1)) return eval(graph, node.tex2, at);
        return (Rgb(1) - amount) * eval(graph, node.tex1, at) + amount * eval(graph, node.tex2, at);
    }
};

}  // namespace

TextureId active_texture(const CheckerboardNode& node, const TexturePoint& at) {
    int sum = 0;
    if (node.dimension == 2) {
        const Vec2 st = map_to_st(node.mapping, at);
        sum = odd(st.x) + odd(st.y);
    } else {
        const Vec3 p = node.texture_from_world.point(at.position);
        sum = odd(p.x) + odd(p.y) + odd(p.z);
    }
    return sum % 2 == 0 ? node.tex1 : node.tex2;
}

Rgb bilerp(const BilerpTexture& node, Vec2 st) {
    return (1 - st.y) * ((1 - st.x) * node.v00 + st.x * node.v10) +
           st.y * ((1 - st.x) * node.v01 + st.x * node.v11);
}

TextureId active_texture(const DotsTexture& node, const TexturePoint& at) {
    const Vec2 st = map_to_st(node.mapping, at);
    const std::optional<Vec2> center = dot_center(st);
    const bool is_inside =
        center && sqr(st.x - center->x) + sqr(st.y - center->y) < sqr(kDotRadius);
    return is_inside ? node.inside : node.outside;
}

FacingNeighbours facing_neighbours(const FacingTexture& texture, float cosine) {
    const auto& cosines = texture.cosines;
    if (!(cosines.front() < 0)) cosine = std::abs(cosine);
    const auto above = std::ranges::upper_bound(cosines, cosine);
    if (above == cosines.begin()) return {texture.textures.front(), texture.textures.front(), 0};
    if (above == cosines.end()) return {texture.textures.back(), texture.textures.back(), 0};
    const auto i = static_cast<size_t>(above - cosines.begin());
    return {texture.textures[i - 1], texture.textures[i],
            (cosine - cosines[i - 1]) / (cosines[i] - cosines[i - 1])};
}

std::vector<float> facing_mean_shares(const FacingTexture& texture) {
    // The density of the cosine c is 2 |c|, or half of that where both sides count. Its integral
    // from 0 is c |c|, and that of c times it 2 |c|^3 / 3. Between two neighbours a and b the
    // second one has the share (c - a) / (b - a).
    const auto& cosines = texture.cosines;
    const auto all_below = [](double c) { return c * std::abs(c); };
    const auto moment_below = [](double c) { return 2.0 / 3 * std::abs(c * c * c); };
    const double least = cosines.front() < 0 ? -1 : 0;
    std::vector<double> shares(cosines.size(), 0.0);
    shares.front() += all_below(cosines.front()) - all_below(least);
    shares.back() += 1 - all_below(cosines.back());
    for (size_t i = 1; i < cosines.size(); ++i) {
        const double a = cosines[i - 1], b = cosines[i];
        const double all = all_below(b) - all_below(a);
        const double second = (moment_below(b) - moment_below(a) - a * all) / (b - a);
        shares[i - 1] += all - second;
        shares[i] += second;
    }
    for (double& share : shares) share /= 1 - least;
    return {shares.begin(), shares.end()};
}

Rgb vertex_colour(const VertexColourTexture& node, const VertexPlace& at) {
    if (!at.mesh || at.mesh->colours.empty()) return Rgb(1);
    const std::array<VertexColour, 3> corners = at.corners(at.mesh->colours);
    const std::array<float, 3> weights = at.weights();
    Rgb sum;
    for (size_t i = 0; i < 3; ++i)
        sum += weights[i] * (node.is_alpha ? Rgb(corners[i].alpha) : corners[i].value);
    return sum;
}

Rgb eval(const TextureGraph& graph, TextureId id, const TexturePoint& at) {
    return std::visit(Evaluator{graph, at}, graph.nodes[size_t(id)]);
}

}  // namespace covtrace
