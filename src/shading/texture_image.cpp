#include "shading/texture_image.h"

#include <algorithm>
#include <utility>

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

/// Channels to keep; alpha only where it says something.
size_t kept_channels(const RasterImage& raster) {
    if (raster.channels != 4) return size_t(raster.channels);
    for (size_t i = 3; i < raster.values.size(); i += 4)
        if (raster.values[i] != 1) return 4;
    return 3;
}

/// v limited to [lo, hi]; lo for NaN, so that the result can always become an index.
float limit(float v, float lo, float hi) {
    return v > lo ? (v < hi ? v : hi) : lo;
}

float fraction(float v) {
    return limit(v - std::floor(v), 0, 1);
}

}  // namespace

float mirrored(float v) {
    const float there = 2 * fraction(0.5f * v);
    return there > 1 ? 2 - there : there;
}

TextureImage::TextureImage(const RasterImage& raster, Encoding encoding, float gamma, Wrap wrap)
    : width_(raster.width), height_(raster.height), channels_(kept_channels(raster)), wrap_(wrap) {
    const size_t texels = size_t(width_) * size_t(height_);
    const size_t stride = size_t(raster.channels);
    if (raster.is_8bit) {
        for (size_t i = 0; i < 256; ++i) decode_[i] = to_linear(float(i) / 255, encoding, gamma);
        bytes_.resize(texels * channels_);
    } else {
        floats_.resize(texels * channels_);
    }
    for (size_t i = 0; i < texels; ++i)
        for (size_t c = 0; c < channels_; ++c) {
            const float v = raster.values[i * stride + c];
            if (raster.is_8bit)
                bytes_[i * channels_ + c] = uint8_t(limit(v * 255 + 0.5f, 0, 255));
            else
                floats_[i * channels_ + c] = to_linear(v, encoding, gamma);
        }
}

uint8_t TextureImage::encode(float v) const {
    const auto above = std::lower_bound(decode_.begin(), decode_.end(), v);
    if (above == decode_.begin()) return 0;
    if (above == decode_.end()) return 255;
    const auto i = above - decode_.begin();
    return uint8_t(v - *(above - 1) < *above - v ? i - 1 : i);
}

void TextureImage::halve() {
    const int width = (width_ + 1) / 2, height = (height_ + 1) / 2;
    const size_t values = size_t(width) * size_t(height) * channels_;
    std::vector<uint8_t> bytes(bytes_.empty() ? 0 : values);
    std::vector<float> floats(bytes_.empty() ? values : 0);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (size_t c = 0; c < channels_; ++c) {
                float sum = 0;
                int count = 0;
                for (int v = 2 * y; v < std::min(2 * y + 2, height_); ++v)
                    for (int u = 2 * x; u < std::min(2 * x + 2, width_); ++u, ++count)
                        sum += channel((size_t(v) * size_t(width_) + size_t(u)) * channels_ + c);
                const size_t i = (size_t(y) * size_t(width) + size_t(x)) * channels_ + c;
                if (bytes_.empty())
                    floats[i] = sum / float(count);
                else
                    bytes[i] = encode(sum / float(count));
            }
    width_ = width;
    height_ = height;
    bytes_ = std::move(bytes);
    floats_ = std::move(floats);
}

Vec2 TextureImage::wrap_st(Vec2 st) const {
    if (wrap_ == Wrap::repeat) return {fraction(st.x), fraction(st.y)};
    if (wrap_ == Wrap::mirror) return {mirrored(st.x), mirrored(st.y)};
    // More than an image away from the image nothing changes any more.
    return {limit(st.x, -1, 2), limit(st.y, -1, 2)};
}

void TextureImage::add_tap(Taps& taps, int x, int y, float weight) const {
    switch (wrap_) {
        case Wrap::repeat:
            x += x < 0 ? width_ : (x >= width_ ? -width_ : 0);
            y += y < 0 ? height_ : (y >= height_ ? -height_ : 0);
            break;
        case Wrap::black:
            if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
            break;
        case Wrap::octahedral_sphere:
            // Crossing a border continues, mirrored, at the opposite half of the same border.
            if (x < 0 || x >= width_) {
                x = x < 0 ? -1 - x : 2 * width_ - 1 - x;
                y = height_ - 1 - y;
            }
            if (y < 0 || y >= height_) {
                y = y < 0 ? -1 - y : 2 * height_ - 1 - y;
                x = width_ - 1 - x;
            }
            [[fallthrough]];
        case Wrap::mirror:
        case Wrap::clamp:
            x = std::clamp(x, 0, width_ - 1);
            y = std::clamp(y, 0, height_ - 1);
            break;
    }
    const auto i = size_t(taps.count++);
    taps.texel[i] = size_t(y) * size_t(width_) + size_t(x);
    taps.weight[i] = weight;
}

TextureImage::Taps TextureImage::nearest(Vec2 st) const {
    const Vec2 at = wrap_st(st);
    Taps taps;
    add_tap(taps, int(std::floor(at.x * float(width_))), int(std::floor(at.y * float(height_))), 1);
    return taps;
}

TextureImage::Taps TextureImage::bilinear(Vec2 st) const {
    const Vec2 at = wrap_st(st);
    const float x = at.x * float(width_) - 0.5f, y = at.y * float(height_) - 0.5f;
    const float left = std::floor(x), top = std::floor(y);
    const float dx = x - left, dy = y - top;
    const int xi = int(left), yi = int(top);
    Taps taps;
    add_tap(taps, xi, yi, (1 - dx) * (1 - dy));
    add_tap(taps, xi + 1, yi, dx * (1 - dy));
    add_tap(taps, xi, yi + 1, (1 - dx) * dy);
    add_tap(taps, xi + 1, yi + 1, dx * dy);
    return taps;
}

Rgb TextureImage::color(size_t texel) const {
    const size_t i = texel * channels_;
    if (channels_ == 1) return Rgb(channel(i));
    return {channel(i), channel(i + 1), channel(i + 2)};
}

float TextureImage::value(size_t texel, Channel which) const {
    const size_t i = texel * channels_;
    switch (which) {
        case Channel::automatic:
            break;
        case Channel::alpha:
            return channels_ == 4 ? channel(i + 3) : 1;
        default:
            if (channels_ == 1) return channel(i);
            return channel(i + (which == Channel::red ? 0 : which == Channel::green ? 1 : 2));
    }
    if (channels_ == 1) return channel(i);
    if (channels_ == 4) return channel(i + 3);
    return (channel(i) + channel(i + 1) + channel(i + 2)) / 3;
}

Rgb TextureImage::color(const Taps& taps) const {
    Rgb sum;
    for (size_t i = 0; i < size_t(taps.count); ++i) sum += color(taps.texel[i]) * taps.weight[i];
    return sum;
}

float TextureImage::value(const Taps& taps, Channel which) const {
    float sum = 0;
    for (size_t i = 0; i < size_t(taps.count); ++i)
        sum += value(taps.texel[i], which) * taps.weight[i];
    return sum;
}

}  // namespace covtrace
