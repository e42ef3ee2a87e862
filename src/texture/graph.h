/// The textures of a scene as a graph of small nodes, ready for evaluation.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "texture/image.h"
#include "texture/texture.h"

namespace covtrace {

struct ConstantNode {
    Rgb value;
};
struct ImageNode {
    int image = -1;           ///< into TextureGraph::images
    bool is_spectrum = true;  ///< else the value of a float texture, in all channels
    TextureImage::Channel channel = TextureImage::Channel::automatic;
    std::optional<float> cutoff;
    ImageTexture::Filter filter = ImageTexture::Filter::bilinear;
    float anisotropy = 8;  ///< at most, of ewa
    float scale = 1;
    bool invert = false;
    TextureMapping mapping;
};
struct CheckerboardNode {
    int dimension = 2;
    TextureMapping mapping;
    Transform texture_from_world;
    TextureId tex1 = -1, tex2 = -1;
};
struct ScaleNode {
    TextureId tex = -1, scale = -1;
};
struct MixNode {
    TextureId tex1 = -1, tex2 = -1, amount = -1;
};
struct FacingNode {
    FacingTexture between;
    /// Share of each texture in the mean over all directions, each counting by its cosine.
    std::vector<float> mean_shares;
};
/// The two neighbours that a texture by the angle of sight is between at a cosine, and the share of
/// the second; the same one twice beyond the ends.
struct FacingNeighbours {
    TextureId first = -1, second = -1;
    float share = 0;
};
using TextureNode = std::variant<ConstantNode, ImageNode, CheckerboardNode, ScaleNode, MixNode,
                                 AsideTexture, DotsTexture, BilerpTexture, NoiseTexture,
                                 VertexColourTexture, CutoffTexture, FacingNode>;

struct TextureGraph {
    std::vector<TextureNode> nodes;  ///< one per TextureId
    std::vector<TextureImage> images;
    size_t page_memory = 0;  ///< bytes for pages of images that are not in memory whole
};

/// The place in an image that (s, t) means: an image's first row is at the top, t = 1.
constexpr Vec2 flip_t(Vec2 st) {
    return {st.x, 1 - st.y};
}
/// The value of an image texture where its image has the given decoded value: scaled, then inverted
/// or compared with the cutoff.
constexpr Rgb image_value(const ImageNode& node, Rgb decoded) {
    const Rgb v = decoded * node.scale;
    if (node.cutoff) return Rgb(v.r >= *node.cutoff ? 1.0f : 0.0f);
    if (!node.invert) return v;
    return {std::max(0.0f, 1 - v.r), std::max(0.0f, 1 - v.g), std::max(0.0f, 1 - v.b)};
}
/// The value of an image texture from one texel of `image`, or from several with weights (Taps).
template <typename Texels>
Rgb image_value_at(const ImageNode& node, const TextureImage& image, const Texels& texels) {
    return image_value(
        node, node.is_spectrum ? image.color(texels) : Rgb(image.value(texels, node.channel)));
}
/// The checkerboard's texture at this point: tex1 where the sum of the cell's coordinates is even.
TextureId active_texture(const CheckerboardNode& node, const TexturePoint& at);
/// Bilinear interpolation of the four corners' values at (s, t).
Rgb bilerp(const BilerpTexture& node, Vec2 st);
/// The texture that the dots show at this point: the one inside of a dot, or the one around the
/// dots.
TextureId active_texture(const DotsTexture& node, const TexturePoint& at);

/// The neighbours at a cosine in [0, 1].
FacingNeighbours facing_neighbours(const FacingTexture& texture, float cosine);
/// Shares of the textures in the mean over a hemisphere, each direction counting by its cosine;
/// their sum is 1.
std::vector<float> facing_mean_shares(const FacingTexture& texture);

/// The colour of a mesh's vertices at a place, or their alpha; 1 where there are none.
Rgb vertex_colour(const VertexColourTexture& node, const VertexPlace& at);

Rgb eval(const TextureGraph& graph, TextureId id, const TexturePoint& at);

}  // namespace covtrace
