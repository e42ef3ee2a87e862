/// An image as textures read it: compact, decoded at each lookup, with its mip levels, the finest
/// of them on disk where memory is short.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/vec.h"
#include "image/raster.h"
#include "scene/scene_description.h"
#include "texture/texel_pages.h"

namespace covtrace {

/// The ellipse that a pixel covers around a place in an image, by its half axes in (s, t). All zero
/// stands for a point.
struct ImageFootprint {
    Vec2 a, b;
};

/// The coordinate in [0, 1] whose texel a mirrored image shows at v: it runs back and forth.
float mirrored(float v);

/// One image with its mip levels. Texels of the first row lie at t = 0 here: callers flip t where
/// they mean a texture's.
class TextureImage {
  public:
    using Encoding = ImageTexture::Encoding;
    using Wrap = ImageTexture::Wrap;
    using Wraps = ImageTexture::Wraps;
    using Filter = ImageTexture::Filter;

    /// Makes an image of one level, the finest. It takes over the raster's memory where that can
    /// be; 8-bit rasters stay 8-bit. `encoding` applies to all channels, alpha included, as in
    /// pbrt-v4. Colours are taken out of `space`.
    TextureImage(RasterImage raster, Encoding encoding, float gamma, Wraps wrap,
                 ColourSpace space = ColourSpace::srgb);

    /// The texels that make up a value, with weights that sum to 1 less those of black
    /// surroundings.
    struct Taps {
        size_t level = 0;
        std::array<size_t, 4> texel{};  ///< row * width + column, of that level
        std::array<float, 4> weight{};
        int count = 0;
    };
    /// The texel around st.
    Taps nearest(Vec2 st, size_t level = 0) const;
    /// The four texels whose centres surround st.
    Taps bilinear(Vec2 st, size_t level = 0) const;

    /// Colour, decoded and linear, with the primaries of Rec.709.
    Rgb color(const Taps& taps) const;
    using Channel = ImageTexture::Channel;
    /// Decoded value of a float texture, whatever the colour space. `automatic`: alpha where there
    /// is one, else the mean of R, G and B. The alpha of an image without is 1.
    float value(const Taps& taps, Channel channel = Channel::automatic) const;
    /// The colour, and below it the float value, of one texel of the finest level, counted row by
    /// row.
    Rgb color(size_t texel) const { return color_at(levels_[0], texel); }
    float value(size_t texel, Channel channel = Channel::automatic) const {
        return value_at(levels_[0], texel, channel);
    }

    /// The mean over a footprint as pbrt-v4's MIPMap takes it. point and bilinear look at the one
    /// level whose texels are next below the longest extent of the footprint, trilinear
    /// interpolates between two such levels; ewa weights the texels of an ellipse by a Gaussian
    /// (Heckbert 1989), on two levels chosen by the shorter axis, at most `anisotropy` times as
    /// long as it is wide. Where a footprint is below a texel all but `point` are `bilinear`.
    Rgb color(Vec2 st, Filter filter, const ImageFootprint& footprint, float anisotropy) const;
    float value(Vec2 st, Filter filter, const ImageFootprint& footprint, float anisotropy,
                Channel channel = Channel::automatic) const;

    /// Makes all coarser levels, down to a single texel: means over 2 x 2 texels (fewer at the far
    /// borders of odd sizes), taken of decoded values and encoded again.
    void build_levels();
    /// Bytes of the finest level that is in memory; 0 where none is.
    size_t finest_in_memory() const;
    /// Moves the finest level that is in memory to the disk. All lookups give the same bits as
    /// before.
    void move_finest_to(const std::shared_ptr<TexelPages>& pages);

    /// Size of the finest level in texels.
    int width() const { return levels_[0].width; }
    int height() const { return levels_[0].height; }
    size_t level_count() const { return levels_.size(); }
    Wraps wrap() const { return wrap_; }
    bool is_paged() const { return levels_[0].pages != nullptr; }
    /// Bytes of all levels that are in memory.
    size_t memory() const;

  private:
    struct Level {
        int width = 0, height = 0;
        Vec2 texels;                 ///< per unit of s and t: not whole where sizes were odd
        std::vector<uint8_t> bytes;  ///< encoded texels: one of the three stores in use
        std::vector<float> floats;   ///< texels already linear: the second store
        /// Encoded or linear texels in square tiles on the disk: the third store. Tiles lie row by
        /// row, one to a page.
        std::shared_ptr<const TexelPages> pages;
        size_t first_page = 0;  ///< page of the first tile
    };
    /// The channels of one texel: one of the two pointers is set.
    struct Texel {
        const uint8_t* bytes = nullptr;
        const float* floats = nullptr;
    };
    /// Room for a texel that is read from a page.
    struct TexelBuffer {
        std::array<uint8_t, 4> bytes;
        std::array<float, 4> floats;
    };
    Texel texel_at(const Level& level, size_t texel, TexelBuffer& buffer) const {
        if (level.pages) [[unlikely]]
            return paged_texel(level, texel, buffer);
        if (is_8bit_) return {level.bytes.data() + texel * channels_, nullptr};
        return {nullptr, level.floats.data() + texel * channels_};
    }
    Texel paged_texel(const Level& level, size_t texel, TexelBuffer& buffer) const;
    float channel(const Texel& texel, size_t c) const {
        return texel.floats ? texel.floats[c] : decode_[texel.bytes[c]];
    }
    size_t texel_bytes() const { return channels_ * (is_8bit_ ? 1 : sizeof(float)); }
    /// Binary logarithm of the side of the largest square tile that fits into a page.
    int tile_bits() const;
    /// The byte that decodes to the value nearest to `v`.
    uint8_t encode(float v) const;
    /// The decoded value at the index `i` (row, column, channel) of a level that is in memory.
    float channel(const Level& level, size_t i) const {
        return is_8bit_ ? decode_[level.bytes[i]] : level.floats[i];
    }
    Rgb color_at(const Level& level, size_t texel) const;
    float value_at(const Level& level, size_t texel, Channel channel) const;
    Level coarser(const Level& fine) const;
    Vec2 wrap_st(Vec2 st) const;
    void add_tap(Taps& taps, int x, int y, float weight) const;
    /// Number of the level at which an extent in (s, t) is about a texel; 0 below, may be
    /// fractional.
    float level_of(float extent) const;
    template <typename Value>
    Value decoded(const Taps& taps, Channel channel) const;
    template <typename Value>
    Value filtered(Vec2 st, Filter filter, ImageFootprint footprint, float anisotropy,
                   Channel channel) const;
    template <typename Value>
    Value ellipse(Vec2 st, const ImageFootprint& footprint, size_t level, Channel channel) const;

    size_t channels_ = 1;
    bool is_8bit_ = false;
    Wraps wrap_;
    ColourSpace space_ = ColourSpace::srgb;
    std::vector<Level> levels_;  ///< the finest first; at least one
    std::array<float, 256> decode_{};
    /// The first byte that decodes to at least j / kEncodeSteps, for every j: where the search of
    /// `encode` begins.
    static constexpr size_t kEncodeSteps = 1024;
    std::array<uint8_t, kEncodeSteps + 1> encode_from_{};
};

}  // namespace covtrace
