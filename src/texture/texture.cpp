#include "texture/texture.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "texture/graph.h"
#include "texture/loader.h"

namespace covtrace {
namespace {

/// Deepest nesting of textures. Evaluation recurses once per level; this keeps it far from the end
/// of any stack.
constexpr int kMaxNesting = 1000;

using Encoding = ImageTexture::Encoding;
/// Key of an image: textures with equal ones share it. The encoding is empty where the file
/// decides.
using ImageKey = std::tuple<std::filesystem::path, const std::string*, std::optional<Encoding>,
                            float, ImageTexture::Wraps, bool>;

ImageKey key_of(const ImageTexture& t) {
    const bool uses_gamma = t.encoding == Encoding::gamma;
    return {t.file.lexically_normal(),   t.content.get(), t.encoding,
            uses_gamma ? t.gamma : 1.0f, t.wrap,          t.is_colour};
}

/// Turns descriptions into nodes, children first, and folds what is constant.
class GraphBuilder {
  public:
    GraphBuilder(const SceneDescription& scene, size_t most_bytes, Warnings& warnings)
        : textures_(scene.textures),
          most_bytes_(most_bytes),
          warnings_(warnings),
          built_(textures_.size(), false),
          lookups_(textures_.size(), 1) {
        graph_.nodes.resize(textures_.size());
    }

    TextureGraph build() {
        for (size_t i = 0; i < textures_.size(); ++i) build(TextureId(i), 1);
        LoadedImages loaded = load_images(requests_, most_bytes_, warnings_);
        graph_.images = std::move(loaded.images);
        graph_.page_memory = loaded.page_memory;
        return std::move(graph_);
    }

  private:
    const TextureNode& build(TextureId id, int depth) {
        const auto i = size_t(id);
        if (built_[i]) return graph_.nodes[i];
        if (depth >= kMaxNesting)
            throw Error(ErrorKind::limit, textures_[i].where,
                        "textures are nested too deeply: expected fewer than " +
                            std::to_string(kMaxNesting) + " levels");
        TextureNode node = std::visit(
            [&](const auto& t) { return make_node(t, textures_[i], depth); }, textures_[i].value);
        // Nested textures multiply their lookups: textures of two textures of two textures each, a
        // few dozen deep, would take for ever.
        constexpr double kMostLookups = 1e4;
        lookups_[i] = std::visit([this](const auto& n) { return lookups_of(n); }, node);
        if (lookups_[i] > kMostLookups)
            throw Error(ErrorKind::limit, textures_[i].where,
                        "the texture is made of more than 10000 others, counted each time that "
                        "they occur");
        built_[i] = true;
        return graph_.nodes[i] = std::move(node);
    }

    double lookups_of(TextureId id) const { return lookups_[size_t(id)]; }
    double lookups_of(const ConstantNode&) const { return 1; }
    double lookups_of(const ImageNode&) const { return 1; }
    double lookups_of(const CheckerboardNode& n) const {
        return 1 + std::max(lookups_of(n.tex1), lookups_of(n.tex2));
    }
    double lookups_of(const DotsTexture& n) const {
        return 1 + std::max(lookups_of(n.inside), lookups_of(n.outside));
    }
    double lookups_of(const AsideTexture&) const { return 1; }
    double lookups_of(const BilerpTexture&) const { return 1; }
    double lookups_of(const NoiseTexture&) const { return 1; }
    double lookups_of(const VertexColourTexture&) const { return 1; }
    double lookups_of(const CutoffTexture& n) const { return 1 + lookups_of(n.tex); }
    double lookups_of(const FacingNode& n) const {
        double sum = 1;
        for (TextureId id : n.between.textures) sum += lookups_of(id);
        return sum;
    }
    double lookups_of(const ScaleNode& n) const {
        return 1 + lookups_of(n.tex) + lookups_of(n.scale);
    }
    double lookups_of(const MixNode& n) const {
        return 1 + lookups_of(n.tex1) + lookups_of(n.tex2) + lookups_of(n.amount);
    }

    const Rgb* constant(const TextureNode& node) const {
        const auto* c = std::get_if<ConstantNode>(&node);
        return c ? &c->value : nullptr;
    }

    TextureNode make_node(const ConstantTexture& t, const TextureDescription&, int) {
        return ConstantNode{t.value};
    }
    TextureNode make_node(const ImageTexture& t, const TextureDescription& d, int) {
        const auto [entry, is_new] = image_ids_.try_emplace(key_of(t), int(requests_.size()));
        if (is_new) requests_.push_back({&t, &d.where});
        if (d.is_spectrum && t.is_colour) requests_[size_t(entry->second)].is_colour = true;
        ImageNode node;
        node.image = entry->second;
        node.is_spectrum = d.is_spectrum;
        node.channel = t.channel;
        node.cutoff = t.cutoff;
        node.filter = t.filter;
        node.anisotropy = t.max_anisotropy;
        node.scale = t.scale;
        node.invert = t.invert;
        node.mapping = t.mapping;
        return node;
    }
    TextureNode make_node(const CheckerboardTexture& t, const TextureDescription&, int depth) {
        const TextureNode& a = build(t.tex1, depth + 1);
        const TextureNode& b = build(t.tex2, depth + 1);
        if (constant(a) && constant(b) && *constant(a) == *constant(b)) return a;
        CheckerboardNode node;
        node.dimension = t.dimension;
        node.mapping = t.mapping;
        node.texture_from_world = t.texture_from_world;
        node.tex1 = t.tex1;
        node.tex2 = t.tex2;
        return node;
    }
    TextureNode make_node(const DotsTexture& t, const TextureDescription&, int depth) {
        const TextureNode& a = build(t.inside, depth + 1);
        const TextureNode& b = build(t.outside, depth + 1);
        if (constant(a) && constant(b) && *constant(a) == *constant(b)) return a;
        return t;
    }
    TextureNode make_node(const AsideTexture& t, const TextureDescription&, int) { return t; }
    TextureNode make_node(const BilerpTexture& t, const TextureDescription&, int) { return t; }
    TextureNode make_node(const NoiseTexture& t, const TextureDescription&, int) { return t; }
    TextureNode make_node(const VertexColourTexture& t, const TextureDescription&, int) {
        return t;
    }
    TextureNode make_node(const CutoffTexture& t, const TextureDescription&, int depth) {
        const Rgb* value = constant(build(t.tex, depth + 1));
        if (value) return ConstantNode{Rgb(value->r >= t.cutoff ? 1.0f : 0.0f)};
        return t;
    }
    TextureNode make_node(const FacingTexture& t, const TextureDescription&, int depth) {
        const TextureNode first = build(t.textures.front(), depth + 1);
        bool is_one = constant(first);
        for (TextureId id : t.textures) {
            const Rgb* value = constant(build(id, depth + 1));
            is_one = is_one && value && *value == *constant(first);
        }
        if (is_one) return first;
        return FacingNode{t, facing_mean_shares(t)};
    }
    TextureNode make_node(const ScaleTexture& t, const TextureDescription&, int depth) {
        const TextureNode& tex = build(t.tex, depth + 1);
        const TextureNode& scale = build(t.scale, depth + 1);
        if (constant(scale)) {
            if (is_black(*constant(scale))) return ConstantNode{};
            if (constant(tex)) return ConstantNode{*constant(tex) * *constant(scale)};
            if (*constant(scale) == Rgb(1)) return tex;
        }
        return ScaleNode{t.tex, t.scale};
    }
    TextureNode make_node(const MixTexture& t, const TextureDescription&, int depth) {
        const TextureNode& a = build(t.tex1, depth + 1);
        const TextureNode& b = build(t.tex2, depth + 1);
        if (const Rgb* amount = constant(build(t.amount, depth + 1))) {
            if (*amount == Rgb(0)) return a;
            if (*amount == Rgb(1)) return b;
            if (constant(a) && constant(b))
                return ConstantNode{(Rgb(1) - *amount) * *constant(a) + *amount * *constant(b)};
        }
        return MixNode{t.tex1, t.tex2, t.amount};
    }

    const std::vector<TextureDescription>& textures_;
    const size_t most_bytes_;
    Warnings& warnings_;
    std::vector<bool> built_;
    /// Lookups of images and constants that one lookup of each texture takes.
    std::vector<double> lookups_;
    std::map<ImageKey, int> image_ids_;
    std::vector<ImageRequest> requests_;
    TextureGraph graph_;
};

}  // namespace

struct TextureStore::Impl {
    TextureGraph graph;
    Warnings warnings;
};

TextureStore::TextureStore(const SceneDescription& scene, size_t most_bytes)
    : impl_(std::make_unique<Impl>()) {
    impl_->graph = GraphBuilder(scene, most_bytes, impl_->warnings).build();
}
TextureStore::~TextureStore() = default;

Rgb TextureStore::eval(TextureId id, const TexturePoint& at) const {
    return covtrace::eval(impl_->graph, id, at);
}

float TextureStore::eval_float(TextureId id, const TexturePoint& at) const {
    return covtrace::eval(impl_->graph, id, at).r;
}

bool TextureStore::is_constant(TextureId id) const {
    return std::holds_alternative<ConstantNode>(impl_->graph.nodes[size_t(id)]);
}

bool TextureStore::has_facing() const {
    return std::ranges::any_of(impl_->graph.nodes, [](const TextureNode& node) {
        return std::holds_alternative<FacingNode>(node);
    });
}

Rgb TextureStore::mean(TextureId id) const {
    double sum[3] = {};
    const auto add = [&sum](Rgb c) { sum[0] += c.r, sum[1] += c.g, sum[2] += c.b; };
    double count = 0;
    if (const auto* node = std::get_if<ImageNode>(&impl_->graph.nodes[size_t(id)])) {
        const TextureImage& image = impl_->graph.images[size_t(node->image)];
        const size_t texels = size_t(image.width()) * size_t(image.height());
        for (size_t i = 0; i < texels; ++i) add(image_value_at(*node, image, i));
        count = double(texels);
    } else {
        // Solid textures are looked up here and there in a box that is large beside their cells: at
        // the points of Roberts' sequence R3 (2018, "The unreasonable effectiveness of quasirandom
        // sequences").
        constexpr int kSide = 64;
        const auto scattered = [](int i, float step) {
            const float x = float(i) * step;
            return 500 * (x - std::floor(x)) - 250;
        };
        for (int i = 0; i < kSide * kSide; ++i)
            add(eval(id, {{(float(i % kSide) + 0.5f) / kSide, (float(i / kSide) + 0.5f) / kSide},
                          {scattered(i, 0.8191725f), scattered(i, 0.6710436f),
                           scattered(i, 0.5497005f)}}));
        count = kSide * kSide;
    }
    return {float(sum[0] / count), float(sum[1] / count), float(sum[2] / count)};
}

const TextureGraph& TextureStore::graph() const {
    return impl_->graph;
}

const Warnings& TextureStore::warnings() const {
    return impl_->warnings;
}

size_t TextureStore::memory() const {
    size_t bytes = impl_->graph.page_memory;
    for (const TextureImage& image : impl_->graph.images) bytes += image.memory();
    return bytes;
}

}  // namespace covtrace
