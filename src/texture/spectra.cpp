#include "texture/spectra.h"

#include <functional>
#include <map>
#include <optional>
#include <tuple>

#include "core/parallel.h"
#include "texture/graph.h"

namespace covtrace {
namespace {

ImageSpectrum::Wrap spectrum_wrap(TextureImage::Wraps wrap) {
    const bool repeats_s = wrap.s == TextureImage::Wrap::repeat;
    if (wrap.t == TextureImage::Wrap::repeat)
        return repeats_s ? ImageSpectrum::Wrap::repeat : ImageSpectrum::Wrap::repeat_t;
    return repeats_s ? ImageSpectrum::Wrap::repeat_s : ImageSpectrum::Wrap::clamp;
}

ImageSpectrum analyse(const TextureGraph& graph, const ImageNode& node) {
    const TextureImage& image = graph.images[size_t(node.image)];
    return {[&](size_t i) { return luminance(image_value_at(node, image, i)); }, image.width(),
            image.height(), spectrum_wrap(image.wrap())};
}

/// Mean luminance of a texture over the unit square of (u, v).
float mean_luminance(const TextureGraph& graph, TextureId id) {
    constexpr int kSide = 16;
    float sum = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const Vec2 uv{(float(i % kSide) + 0.5f) / kSide, (float(i / kSide) + 0.5f) / kSide};
        sum += luminance(eval(graph, id, {uv, {}}));
    }
    return sum / (kSide * kSide);
}

/// Spectrum of a mix whose amount is an image. An amount has no contrast of its own: a trace of
/// chalk on a cloth is as visible as the difference it makes there. So the image that is analysed
/// is the mixture of the two textures' means.
ImageSpectrum analyse_mixture(const TextureGraph& graph, const MixNode& mix,
                              const ImageNode& amount) {
    const TextureImage& image = graph.images[size_t(amount.image)];
    const float a = mean_luminance(graph, mix.tex1), b = mean_luminance(graph, mix.tex2);
    return {[&](size_t i) { return a + luminance(image_value_at(amount, image, i)) * (b - a); },
            image.width(), image.height(), spectrum_wrap(image.wrap())};
}

/// Key of all that an image's spectrum depends on. The analysis is relative to the mean: a scale
/// matters only where an inversion or a cutoff follows it.
using SpectrumKey = std::tuple<int, bool, bool, float, TextureImage::Channel, std::optional<float>>;
SpectrumKey key_of(const ImageNode& n) {
    return {n.image,   n.is_spectrum, n.invert, n.invert || n.cutoff ? n.scale : 1.0f,
            n.channel, n.cutoff};
}

}  // namespace

TextureSpectra::TextureSpectra(const TextureStore& textures, TextureBandwidth bandwidth)
    : graph_(&textures.graph()), bandwidth_(bandwidth) {
    const TextureGraph& graph = *graph_;
    image_of_texture_.assign(graph.nodes.size(), -1);
    if (bandwidth == TextureBandwidth::highest) return;
    // Each distinct image is one job: most are too small to fill the cores alone.
    std::vector<std::function<ImageSpectrum()>> jobs;
    std::map<SpectrumKey, int> known;
    for (size_t i = 0; i < graph.nodes.size(); ++i) {
        const auto* node = std::get_if<ImageNode>(&graph.nodes[i]);
        if (!node) continue;
        const auto [entry, is_new] = known.try_emplace(key_of(*node), int(jobs.size()));
        if (is_new) jobs.push_back([&graph, node] { return analyse(graph, *node); });
        image_of_texture_[i] = entry->second;
    }
    for (size_t i = 0; i < graph.nodes.size(); ++i) {
        const auto* mix = std::get_if<MixNode>(&graph.nodes[i]);
        if (!mix) continue;
        const auto* amount = std::get_if<ImageNode>(&graph.nodes[size_t(mix->amount)]);
        if (!amount) continue;
        image_of_texture_[i] = int(jobs.size());
        jobs.push_back([&graph, mix, amount] { return analyse_mixture(graph, *mix, *amount); });
    }
    images_.resize(jobs.size());
    parallel_for(int64_t(jobs.size()), [&](int64_t i) { images_[size_t(i)] = jobs[size_t(i)](); });
}

size_t TextureSpectra::memory() const {
    size_t bytes = 0;
    for (const ImageSpectrum& spectrum : images_) bytes += spectrum.memory();
    return bytes;
}

}  // namespace covtrace
