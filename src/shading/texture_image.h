/// An image as textures read it: compact in memory, decoded at each lookup.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "image/raster.h"
#include "scene/scene_description.h"

namespace covtrace {

/// Texels of the first row lie at t = 0 here: callers flip t where they mean a texture's.
/// The coordinate in [0, 1] whose texel a mirrored image shows at v: it runs back and forth.
float mirrored(float v);

class TextureImage {
  public:
    using Encoding = ImageTexture::Encoding;
    using Wrap = ImageTexture::Wrap;

    /// 8-bit rasters stay 8-bit. `encoding` applies to all channels, alpha included, as in pbrt-v4.
    TextureImage(const RasterImage& raster, Encoding encoding, float gamma, Wrap wrap);

    /// The texels that make up a value, with weights that sum to 1 less those of black
    /// surroundings.
    struct Taps {
        std::array<size_t, 4> texel{};  ///< row * width + column
        std::array<float, 4> weight{};
        int count = 0;
    };
    /// The texel around st.
    Taps nearest(Vec2 st) const;
    /// The four texels whose centres surround st.
    Taps bilinear(Vec2 st) const;

    /// Decoded colour.
    Rgb color(const Taps& taps) const;
    using Channel = ImageTexture::Channel;
    /// Decoded value of a float texture; 1 for the alpha of an image without.
    float value(const Taps& taps, Channel channel = Channel::automatic) const;
    Rgb color(size_t texel) const;
    float value(size_t texel, Channel channel = Channel::automatic) const;

    /// Drops the finest mip level: means over 2 x 2 texels (fewer at the far borders of odd sizes),
    /// taken of decoded values and encoded again. Images of one texel stay as they are.
    void halve();

    int width() const { return width_; }
    int height() const { return height_; }
    Wrap wrap() const { return wrap_; }
    size_t memory() const { return bytes_.size() + floats_.size() * sizeof(float); }

  private:
    /// The byte that decodes to the value nearest to `v`.
    uint8_t encode(float v) const;
    float channel(size_t i) const { return bytes_.empty() ? floats_[i] : decode_[bytes_[i]]; }
    Vec2 wrap_st(Vec2 st) const;
    void add_tap(Taps& taps, int x, int y, float weight) const;

    int width_ = 0, height_ = 0;
    size_t channels_ = 1;
    Wrap wrap_ = Wrap::repeat;
    std::vector<uint8_t> bytes_;  ///< either these,
    std::vector<float> floats_;   ///< or these, already linear
    std::array<float, 256> decode_{};
};

}  // namespace covtrace
