#include "texture/image.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "image/color_encoding.h"

namespace covtrace {
namespace {

float to_linear(float v, TextureImage::Encoding encoding, float gamma) {
    switch (encoding) {
        case TextureImage::Encoding::srgb:
            return srgb_decode(v);
        case TextureImage::Encoding::gamma:
            return std::pow(std::max(v, 0.0f), gamma);
        default:
            return v;
    }
}

/// Number of a raster's channels to keep: alpha is kept only where it is not 1 everywhere.
size_t kept_channels(const RasterImage& raster) {
    if (raster.channels != 4) return size_t(raster.channels);
    for (size_t i = 3; i < raster.size(); i += 4)
        if (raster.value(i) != 1) return 4;
    return 3;
}

/// Leaves the first `kept` of every `stride` values.
template <typename Value>
void drop_channels(std::vector<Value>& values, size_t stride, size_t kept) {
    if (stride == kept) return;
    const size_t count = values.size() / stride;
    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < kept; ++c) values[i * kept + c] = values[i * stride + c];
    values.resize(count * kept);
    values.shrink_to_fit();
}

/// v limited to [lo, hi]; lo for NaN, so that the result can always become an index.
float limit(float v, float lo, float hi) {
    return v > lo ? (v < hi ? v : hi) : lo;
}

float fraction(float v) {
    return limit(v - std::floor(v), 0, 1);
}

/// Replaces the index of a texel, at most one image's size outside, by that of the one that stands
/// for it; false where that is black.
bool continue_axis(int& i, int size, ImageTexture::Wrap wrap) {
    if (wrap == ImageTexture::Wrap::repeat) {
        i += i < 0 ? size : (i >= size ? -size : 0);
        return true;
    }
    if (wrap == ImageTexture::Wrap::black && (i < 0 || i >= size)) return false;
    i = std::clamp(i, 0, size - 1);
    return true;
}

}  // namespace

float mirrored(float v) {
    const float there = 2 * fraction(0.5f * v);
    return there > 1 ? 2 - there : there;
}

TextureImage::TextureImage(RasterImage raster, Encoding encoding, float gamma, Wraps wrap,
                           ColourSpace space)
    : channels_(kept_channels(raster)), is_8bit_(raster.is_8bit), wrap_(wrap), space_(space) {
    Level level;
    level.width = raster.width;
    level.height = raster.height;
    level.texels = {float(level.width), float(level.height)};
    if (raster.is_8bit) {
        for (size_t i = 0; i < 256; ++i) decode_[i] = to_linear(float(i) / 255, encoding, gamma);
        for (size_t j = 0; j <= kEncodeSteps; ++j)
            encode_from_[j] = uint8_t(
                std::lower_bound(decode_.begin(), decode_.end() - 1, float(j) / kEncodeSteps) -
                decode_.begin());
        level.bytes = std::move(raster.bytes);
        drop_channels(level.bytes, size_t(raster.channels), channels_);
    } else {
        level.floats = std::move(raster.values);
        drop_channels(level.floats, size_t(raster.channels), channels_);
        for (float& v : level.floats) v = to_linear(v, encoding, gamma);
    }
    levels_.push_back(std::move(level));
}

uint8_t TextureImage::encode(float v) const {
    if (!(v > decode_.front())) return 0;  // NaN, too: the gamma is the file's
    if (v > decode_.back()) return 255;
    size_t i = encode_from_[size_t(v * kEncodeSteps)];
    while (decode_[i] < v) ++i;
    return uint8_t(v - decode_[i - 1] < decode_[i] - v ? i - 1 : i);
}

TextureImage::Level TextureImage::coarser(const Level& fine) const {
    Level level;
    level.width = (fine.width + 1) / 2;
    level.height = (fine.height + 1) / 2;
    level.texels = {fine.width > 1 ? fine.texels.x / 2 : fine.texels.x,
                    fine.height > 1 ? fine.texels.y / 2 : fine.texels.y};
    const size_t values = size_t(level.width) * size_t(level.height) * channels_;
    if (is_8bit_)
        level.bytes.resize(values);
    else
        level.floats.resize(values);
    parallel_for(level.height, [&](int64_t row) {
        const int y = int(row), rows = std::min(2, fine.height - 2 * y);
        for (int x = 0; x < level.width; ++x) {
            const int columns = std::min(2, fine.width - 2 * x);
            const size_t from = size_t(2 * y) * size_t(fine.width) + size_t(2 * x);
            const size_t to = (size_t(y) * size_t(level.width) + size_t(x)) * channels_;
            for (size_t c = 0; c < channels_; ++c) {
                float sum = 0;
                for (int v = 0; v < rows; ++v)
                    for (int u = 0; u < columns; ++u)
                        sum += channel(
                            fine,
                            (from + size_t(v) * size_t(fine.width) + size_t(u)) * channels_ + c);
                const float mean = sum / float(rows * columns);
                if (is_8bit_)
                    level.bytes[to + c] = encode(mean);
                else
                    level.floats[to + c] = mean;
            }
        }
    });
    return level;
}

void TextureImage::build_levels() {
    while (levels_.back().width > 1 || levels_.back().height > 1)
        levels_.push_back(coarser(levels_.back()));
}

size_t TextureImage::memory() const {
    size_t bytes = 0;
    for (const Level& level : levels_)
        bytes += level.bytes.size() + level.floats.size() * sizeof(float);
    return bytes;
}

Vec2 TextureImage::wrap_st(Vec2 st) const {
    const auto one_axis = [](float v, Wrap wrap) {
        if (wrap == Wrap::repeat) return fraction(v);
        if (wrap == Wrap::mirror) return mirrored(v);
        // The lookup is limited to one image's size around the image, beyond which its values don't
        // change any more.
        return limit(v, -1, 2);
    };
    return {one_axis(st.x, wrap_.s), one_axis(st.y, wrap_.t)};
}

void TextureImage::add_tap(Taps& taps, int x, int y, float weight) const {
    const int width = levels_[taps.level].width, height = levels_[taps.level].height;
    if (wrap_.s == Wrap::octahedral_sphere) {
        // On the octahedral sphere a path across a border continues, mirrored, at the opposite half
        // of the same border.
        if (x < 0 || x >= width) {
            x = x < 0 ? -1 - x : 2 * width - 1 - x;
            y = height - 1 - y;
        }
        if (y < 0 || y >= height) {
            y = y < 0 ? -1 - y : 2 * height - 1 - y;
            x = width - 1 - x;
        }
    }
    if (!continue_axis(x, width, wrap_.s) || !continue_axis(y, height, wrap_.t)) return;
    const auto i = size_t(taps.count++);
    taps.texel[i] = size_t(y) * size_t(width) + size_t(x);
    taps.weight[i] = weight;
}

TextureImage::Taps TextureImage::nearest(Vec2 st, size_t level) const {
    const Vec2 at = wrap_st(st), scale = levels_[level].texels;
    Taps taps;
    taps.level = level;
    add_tap(taps, int(std::floor(at.x * scale.x)), int(std::floor(at.y * scale.y)), 1);
    return taps;
}

TextureImage::Taps TextureImage::bilinear(Vec2 st, size_t level) const {
    const Vec2 at = wrap_st(st), scale = levels_[level].texels;
    const float x = at.x * scale.x - 0.5f, y = at.y * scale.y - 0.5f;
    const float left = std::floor(x), top = std::floor(y);
    const float dx = x - left, dy = y - top;
    const int xi = int(left), yi = int(top);
    Taps taps;
    taps.level = level;
    add_tap(taps, xi, yi, (1 - dx) * (1 - dy));
    add_tap(taps, xi + 1, yi, dx * (1 - dy));
    add_tap(taps, xi, yi + 1, (1 - dx) * dy);
    add_tap(taps, xi + 1, yi + 1, dx * dy);
    return taps;
}

Rgb TextureImage::color_at(const Level& level, size_t texel) const {
    TexelBuffer buffer;
    const Texel t = texel_at(level, texel, buffer);
    if (channels_ == 1) return Rgb(channel(t, 0));
    return clipped_to_rec709({channel(t, 0), channel(t, 1), channel(t, 2)}, space_);
}

float TextureImage::value_at(const Level& level, size_t texel, Channel which) const {
    TexelBuffer buffer;
    const Texel t = texel_at(level, texel, buffer);
    switch (which) {
        case Channel::automatic:
            break;
        case Channel::alpha:
            return channels_ == 4 ? channel(t, 3) : 1;
        default:
            if (channels_ == 1) return channel(t, 0);
            return channel(t, which == Channel::red ? 0 : which == Channel::green ? 1 : 2);
    }
    if (channels_ == 1) return channel(t, 0);
    if (channels_ == 4) return channel(t, 3);
    return (channel(t, 0) + channel(t, 1) + channel(t, 2)) / 3;
}

Rgb TextureImage::color(const Taps& taps) const {
    const Level& level = levels_[taps.level];
    Rgb sum;
    for (size_t i = 0; i < size_t(taps.count); ++i)
        sum += color_at(level, taps.texel[i]) * taps.weight[i];
    return sum;
}

float TextureImage::value(const Taps& taps, Channel which) const {
    const Level& level = levels_[taps.level];
    float sum = 0;
    for (size_t i = 0; i < size_t(taps.count); ++i)
        sum += value_at(level, taps.texel[i], which) * taps.weight[i];
    return sum;
}

}  // namespace covtrace
