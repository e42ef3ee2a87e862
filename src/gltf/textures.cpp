#include "gltf/textures.h"

#include <cmath>

#include "gltf/extensions.h"

namespace covtrace::gltf {
namespace {

using Wrap = ImageTexture::Wrap;

Wrap wrap_mode(const Document& document, int mode, const std::string& place) {
    switch (mode) {
        case TINYGLTF_TEXTURE_WRAP_REPEAT:
            return Wrap::repeat;
        case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
            return Wrap::clamp;
        case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
            return Wrap::mirror;
        default:
            document.refuse(
                place, std::to_string(mode) + " is no way to wrap; expected 10497, 33071 or 33648");
    }
}

/// The mapping of KHR_texture_transform: (u, v) of the image = offset + R(rotation) scale (u, v), v
/// downwards. Meshes and lookups both turn v here, v = 1 - v', which turns the sign of the
/// off-diagonal.
TextureMapping mapping_of(const Document& document, const tinygltf::TextureInfo& info,
                          const std::string& place) {
    TextureMapping mapping;
    const tinygltf::Value* transform = extension(info.extensions, "KHR_texture_transform");
    if (!transform) return mapping;
    const std::string here = place + ".extensions.KHR_texture_transform";
    constexpr double kAny = -1e30;
    const auto offset = numbers<2>(document, *transform, "offset", {0, 0}, kAny, here);
    const auto scale = numbers<2>(document, *transform, "scale", {1, 1}, kAny, here);
    const double angle = number(document, *transform, "rotation", 0, kAny, 1e30, here);
    const double c = std::cos(angle), s = std::sin(angle);
    const double uu = c * scale[0], uv = s * scale[1], vu = -s * scale[0], vv = c * scale[1];
    mapping.scale_u = static_cast<float>(uu);
    mapping.u_per_v = static_cast<float>(-uv);
    mapping.delta_u = static_cast<float>(offset[0] + uv);
    mapping.v_per_u = static_cast<float>(-vu);
    mapping.scale_v = static_cast<float>(vv);
    mapping.delta_v = static_cast<float>(1 - offset[1] - vv);
    return mapping;
}

/// Index of the image of a texture: the WebP one where there is one, else the one for readers that
/// know no extension; -1 where there is none.
int source_of(const Document& document, const tinygltf::Texture& texture,
              const std::string& place) {
    const tinygltf::Value* webp = extension(texture.extensions, "EXT_texture_webp");
    if (!webp) return texture.source;
    constexpr double kLargestIndex = 1 << 30;
    return static_cast<int>(number(document, *webp, "source", texture.source, 0, kLargestIndex,
                                   place + ".extensions.EXT_texture_webp"));
}

}  // namespace

int TextureReader::uv_set(const Document& document, const tinygltf::TextureInfo& info,
                          const std::string& place) {
    int set = info.texCoord;
    if (const tinygltf::Value* t = extension(info.extensions, "KHR_texture_transform"))
        set = static_cast<int>(number(document, *t, "texCoord", set, 0, 1e6,
                                      place + ".extensions.KHR_texture_transform"));
    if (set < 0) document.refuse(place + ".texCoord", "expected a number of at least 0");
    return set;
}

TextureId TextureReader::add(TextureDescription texture) {
    scene_.textures.push_back(std::move(texture));
    return static_cast<TextureId>(scene_.textures.size() - 1);
}

TextureId TextureReader::constant(Rgb value, bool is_spectrum) {
    return add({{}, is_spectrum, ConstantTexture{value}, document_.place("")});
}

TextureId TextureReader::product(TextureId a, TextureId b, bool is_spectrum) {
    return add({{}, is_spectrum, ScaleTexture{a, b}, document_.place("")});
}

TextureId TextureReader::mixture(TextureId a, TextureId b, TextureId amount) {
    return add({{}, false, MixTexture{a, b, amount}, document_.place("")});
}

TextureId TextureReader::vertex_colour(bool is_alpha) {
    return add({{}, !is_alpha, VertexColourTexture{is_alpha}, document_.place("")});
}

TextureId TextureReader::cutoff(TextureId texture, float cutoff) {
    return add({{}, false, CutoffTexture{texture, cutoff}, document_.place("")});
}

std::optional<ImageTexture> TextureReader::image(const TextureUse& info, const std::string& place) {
    if (info.index < 0) return std::nullopt;
    const auto& model = document_.model;
    const tinygltf::Texture& texture =
        at(document_, model.textures, info.index, "textures", place + ".index");
    const std::string texture_place = element("textures", static_cast<size_t>(info.index));
    warn_of_left_out(document_, texture.extensions, texture_place, log_);
    const int source_index = source_of(document_, texture, texture_place);
    if (source_index < 0) {
        log_.add(document_.place(texture_place),
                 "a texture without an image of a known format (PNG, JPEG, WebP) is left out");
        return std::nullopt;
    }
    const tinygltf::Image& source =
        at(document_, model.images, source_index, "images", texture_place + ".source");
    const std::string image_place = element("images", static_cast<size_t>(source_index));

    ImageTexture result;
    result.mapping = mapping_of(document_, info, place);
    result.mapping.uv_set = info.mapped_set;
    if (texture.sampler >= 0) {
        const tinygltf::Sampler& sampler =
            at(document_, model.samplers, texture.sampler, "samplers", texture_place + ".sampler");
        const std::string here = element("samplers", static_cast<size_t>(texture.sampler));
        result.wrap = {wrap_mode(document_, sampler.wrapS, here + ".wrapS"),
                       wrap_mode(document_, sampler.wrapT, here + ".wrapT")};
        if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST)
            result.filter = ImageTexture::Filter::point;
    }
    if (!source.uri.empty()) {
        result.file = find_file(document_, source.uri, image_place + ".uri");
        return result;
    }
    auto& content = contents_[source_index];
    if (!content)
        content = std::make_shared<const std::string>(source.image.begin(), source.image.end());
    result.content = content;
    result.file = image_place;
    return result;
}

TextureId TextureReader::colour(const TextureUse& info, Rgb factor, const std::string& place) {
    auto texture = image(info, place);
    if (!texture) return constant(factor, true);
    texture->encoding = ImageTexture::Encoding::srgb;
    const TextureId id = add({{}, true, *texture, document_.place(place)});
    return factor == Rgb(1) ? id : product(id, constant(factor, true), true);
}

TextureId TextureReader::linear(const TextureUse& info, const std::string& place) {
    auto texture = image(info, place);
    if (!texture) return -1;
    texture->encoding = ImageTexture::Encoding::linear;
    texture->is_colour = false;
    return add({{}, true, *texture, document_.place(place)});
}

TextureId TextureReader::channel(const TextureUse& info, ImageTexture::Channel which, float factor,
                                 const std::string& place) {
    auto texture = image(info, place);
    if (!texture) return constant(factor);
    texture->encoding = ImageTexture::Encoding::linear;
    texture->channel = which;
    texture->scale = factor;
    return add({{}, false, *texture, document_.place(place)});
}

TextureId TextureReader::inverted_channel(const TextureUse& info, ImageTexture::Channel which,
                                          float factor, const std::string& place) {
    const TextureId id = channel(info, which, factor, place);
    TextureDescription& texture = scene_.textures[static_cast<size_t>(id)];
    if (auto* image = std::get_if<ImageTexture>(&texture.value))
        image->invert = true;
    else
        texture.value = ConstantTexture{Rgb(1 - factor)};
    return id;
}

TextureId TextureReader::mask(const TextureUse& info, float cutoff, const std::string& place) {
    auto texture = image(info, place);
    if (!texture) return -1;
    texture->encoding = ImageTexture::Encoding::linear;
    texture->channel = ImageTexture::Channel::alpha;
    texture->cutoff = cutoff;
    return add({{}, false, *texture, document_.place(place)});
}

}  // namespace covtrace::gltf
