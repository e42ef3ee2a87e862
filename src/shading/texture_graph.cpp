#include "shading/texture_graph.h"

#include "shading/texture_mapping.h"

namespace covtrace {
namespace {

/// 1 in cells with an odd coordinate, else 0; exact for coordinates of any size.
int odd(float v) {
    const float cell = std::floor(v);
    return cell - 2 * std::floor(0.5f * cell) == 1 ? 1 : 0;
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

Rgb eval(const TextureGraph& graph, TextureId id, const TexturePoint& at) {
    return std::visit(Evaluator{graph, at}, graph.nodes[size_t(id)]);
}

}  // namespace covtrace
