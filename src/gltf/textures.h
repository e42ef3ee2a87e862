/// Private to this folder: texture references as textures of the scene.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "gltf/document.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// A reference to a texture, and where its coordinates are in the meshes: TextureMapping::uv_set.
struct TextureUse : tinygltf::TextureInfo {
    int mapped_set = -1;
};

class TextureReader {
  public:
    TextureReader(const Document& document, SceneDescription& scene, WarningLog& log)
        : document_(document), scene_(scene), log_(log) {}

    TextureId constant(Rgb value, bool is_spectrum);
    TextureId constant(float value) { return constant(Rgb(value), false); }
    TextureId product(TextureId a, TextureId b, bool is_spectrum);
    /// Float texture (1 - amount) a + amount b.
    TextureId mixture(TextureId a, TextureId b, TextureId amount);
    /// The colours of vertices, or their alpha.
    TextureId vertex_colour(bool is_alpha);
    /// Texture that is 1 where another one is at least `cutoff`, 0 elsewhere.
    TextureId cutoff(TextureId texture, float cutoff);

    /// Texture of an sRGB image times factor; the factor alone where there is no (usable) image.
    TextureId colour(const TextureUse& info, Rgb factor, const std::string& place);
    /// Texture of a linear colour image; -1 where there is none.
    TextureId linear(const TextureUse& info, const std::string& place);
    /// Texture of one channel of a linear image times factor.
    TextureId channel(const TextureUse& info, ImageTexture::Channel channel, float factor,
                      const std::string& place);
    /// Texture of 1 less the channel of a linear image times factor.
    TextureId inverted_channel(const TextureUse& info, ImageTexture::Channel channel, float factor,
                               const std::string& place);
    /// Texture that is 1 where the image's alpha is at least `cutoff`, 0 elsewhere; -1 where there
    /// is no image.
    TextureId mask(const TextureUse& info, float cutoff, const std::string& place);

    /// The set of texture coordinates of a reference, with its KHR_texture_transform.
    static int uv_set(const Document& document, const tinygltf::TextureInfo& info,
                      const std::string& place);

  private:
    /// The image of a reference; empty, with a warning, where its format is not supported.
    std::optional<ImageTexture> image(const TextureUse& info, const std::string& place);
    TextureId add(TextureDescription texture);

    const Document& document_;
    SceneDescription& scene_;
    WarningLog& log_;
    std::map<int, std::shared_ptr<const std::string>> contents_;  ///< of embedded images
};

}  // namespace covtrace::gltf
