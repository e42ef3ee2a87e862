/// Private to this folder: texture references as textures of the scene.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "gltf/document.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

class TextureReader {
  public:
    TextureReader(const Document& document, SceneDescription& scene, WarningLog& log)
        : document_(document), scene_(scene), log_(log) {}

    TextureId constant(Rgb value, bool is_spectrum);
    TextureId constant(float value) { return constant(Rgb(value), false); }
    TextureId product(TextureId a, TextureId b, bool is_spectrum);

    /// Texture of an sRGB image times factor; the factor alone where there is no (usable) image.
    TextureId colour(const tinygltf::TextureInfo& info, Rgb factor, const std::string& place);
    /// Texture of a linear colour image; -1 where there is none.
    TextureId linear(const tinygltf::TextureInfo& info, const std::string& place);
    /// Texture of one channel of a linear image times factor.
    TextureId channel(const tinygltf::TextureInfo& info, ImageTexture::Channel channel,
                      float factor, const std::string& place);
    /// Texture that is 1 where the image's alpha is at least `cutoff`, 0 elsewhere; -1 where there
    /// is no image.
    TextureId mask(const tinygltf::TextureInfo& info, float cutoff, const std::string& place);

    /// The set of texture coordinates of a reference, with its KHR_texture_transform.
    static int uv_set(const Document& document, const tinygltf::TextureInfo& info,
                      const std::string& place);

  private:
    /// The image of a reference; empty, with a warning, where its format is not supported.
    std::optional<ImageTexture> image(const tinygltf::TextureInfo& info, const std::string& place);
    TextureId add(TextureDescription texture);

    const Document& document_;
    SceneDescription& scene_;
    WarningLog& log_;
    std::map<int, std::shared_ptr<const std::string>> contents_;  ///< of embedded images
};

}  // namespace covtrace::gltf
