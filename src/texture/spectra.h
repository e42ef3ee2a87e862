/// How fast the textures of a scene vary over their surfaces.
#pragma once

#include <vector>

#include "core/enum_names.h"
#include "texture/image_spectrum.h"
#include "texture/texture.h"

namespace covtrace {

/// How fast the frequency analysis takes textures to vary.
enum class TextureBandwidth {
    own,  ///< each texture by its own values
    /// Every texture as the image can show at most: as if every pixel saw an edge along both axes.
    highest
};

template <>
inline constexpr auto kEnumNames<TextureBandwidth> = enum_names<TextureBandwidth>(
    {{TextureBandwidth::own, "own"}, {TextureBandwidth::highest, "highest"}});

/// The spectra of all textures of a scene, images analysed once for all textures that show the same
/// values. Thread-safe.
class TextureSpectra {
  public:
    /// Images are analysed in detail where they are asked for. `textures` must outlive this.
    explicit TextureSpectra(const TextureStore& textures,
                            TextureBandwidth bandwidth = TextureBandwidth::own);

    /// Covariance of the texture's amplitude spectrum per unit of the surface's (u, v) around `at`:
    /// edges by their distance (never closer than `footprint_uv`, half a pixel's footprint in uv
    /// units), images by windows of all sizes. Textures that are mapped by position are first
    /// expressed in (u, v) with dpdu, dpdv.
    SpatialCovariance2 uv_covariance(TextureId id, const TexturePoint& at, Vec3 dpdu, Vec3 dpdv,
                                     float footprint_uv) const;
    /// The spectrum of the image that a texture shows or, of a mix whose amount is an image, of the
    /// mixture of both textures' means. Null for other textures.
    const ImageSpectrum* of_image(TextureId id) const {
        const int image = image_of_texture_[size_t(id)];
        return image < 0 ? nullptr : &images_[size_t(image)];
    }
    size_t memory() const;  ///< bytes; not while others look up

  private:
    const TextureGraph* graph_;
    TextureBandwidth bandwidth_;
    std::vector<ImageSpectrum> images_;
    std::vector<int> image_of_texture_;  ///< into images_; -1: none
};

}  // namespace covtrace
