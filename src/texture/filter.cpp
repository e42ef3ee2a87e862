// Lookups in the mip levels of a TextureImage, by the footprint of a pixel.
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "texture/image.h"

namespace covtrace {

namespace {

int wrapped(int i, int n) {
    const int r = i % n;
    return r < 0 ? r + n : r;
}

}  // namespace

template <typename Value>
Value TextureImage::decoded(const Taps& taps, [[maybe_unused]] Channel channel) const {
    if constexpr (std::is_same_v<Value, float>)
        return value(taps, channel);
    else
        return color(taps);
}

float TextureImage::level_of(float extent) const {
    const float texels = extent * std::max(levels_[0].texels.x, levels_[0].texels.y);
    // Level 0 serves extents below a texel, and those that are not a number.
    if (!(texels > 1)) return 0;
    return std::min(std::log2(texels), float(levels_.size() - 1));
}

template <typename Value>
Value TextureImage::ellipse(Vec2 st, const ImageFootprint& footprint, size_t level,
                            Channel channel) const {
    level = std::min(level, levels_.size() - 1);
    const Level& l = levels_[level];
    const Vec2 at = wrap_st(st);
    const float x = at.x * l.texels.x - 0.5f, y = at.y * l.texels.y - 0.5f;
    const Vec2 a{footprint.a.x * l.texels.x, footprint.a.y * l.texels.y},
        b{footprint.b.x * l.texels.x, footprint.b.y * l.texels.y};
    // The ellipse is A x^2 + B x y + C y^2 < 1, widened by a texel's radius (Heckbert 1989,
    // "Fundamentals of Texture Mapping and Image Warping", section 3.5.8).
    float A = a.y * a.y + b.y * b.y + 1, B = -2 * (a.x * a.y + b.x * b.y),
          C = a.x * a.x + b.x * b.x + 1;
    const float scale = 1 / (A * C - 0.25f * B * B);
    A *= scale, B *= scale, C *= scale;
    const float determinant = 4 * A * C - B * B;
    const float half_width = 2 * std::sqrt(C / determinant),
                half_height = 2 * std::sqrt(A / determinant);
    Value sum{};
    float weights = 0;
    for (int j = int(std::ceil(y - half_height)); float(j) <= y + half_height; ++j)
        for (int i = int(std::ceil(x - half_width)); float(i) <= x + half_width; ++i) {
            const float dx = float(i) - x, dy = float(j) - y;
            const float r2 = A * dx * dx + B * dx * dy + C * dy * dy;
            if (!(r2 < 1)) continue;
            // The filter is a Gaussian that falls to zero at the ellipse's rim.
            const float weight = std::exp(-2 * r2) - std::exp(-2.0f);
            Taps taps;
            taps.level = level;
            add_tap(taps, wrap_.s == Wrap::repeat ? wrapped(i, l.width) : i,
                    wrap_.t == Wrap::repeat ? wrapped(j, l.height) : j, weight);
            sum += decoded<Value>(taps, channel);
            weights += weight;
        }
    return weights > 0 ? sum * (1 / weights) : decoded<Value>(bilinear(st, level), channel);
}

template <typename Value>
Value TextureImage::filtered(Vec2 st, Filter filter, ImageFootprint footprint, float anisotropy,
                             Channel channel) const {
    const auto between = [](float t, Value fine, Value coarse) {
        return fine * (1 - t) + coarse * t;
    };
    float longer = length(footprint.a), shorter = length(footprint.b);
    if (filter == Filter::ewa && std::isfinite(longer) && std::isfinite(shorter)) {
        if (longer < shorter) {
            std::swap(longer, shorter);
            std::swap(footprint.a, footprint.b);
        }
        if (shorter > 0 && shorter * anisotropy < longer) {
            const float stretch = longer / (shorter * anisotropy);
            footprint.b = footprint.b * stretch;
            shorter *= stretch;
        }
        if (shorter > 0 && level_of(longer) > 0) {
            const float level = level_of(shorter), fine = std::floor(level);
            // The coarsest level serves all larger ellipses, however many repeats of the image they
            // cover.
            if (level >= float(levels_.size() - 1))
                return decoded<Value>(bilinear(st, levels_.size() - 1), channel);
            const Value first = ellipse<Value>(st, footprint, size_t(fine), channel);
            if (level == fine) return first;
            return between(level - fine, first,
                           ellipse<Value>(st, footprint, size_t(fine) + 1, channel));
        }
        return decoded<Value>(bilinear(st), channel);
    }
    const float extent = 2 * std::max({std::abs(footprint.a.x), std::abs(footprint.a.y),
                                       std::abs(footprint.b.x), std::abs(footprint.b.y)});
    const float level = level_of(extent), fine = std::floor(level);
    if (filter == Filter::point) return decoded<Value>(nearest(st, size_t(fine)), channel);
    const Value first = decoded<Value>(bilinear(st, size_t(fine)), channel);
    if (filter != Filter::trilinear || level == fine) return first;
    return between(level - fine, first, decoded<Value>(bilinear(st, size_t(fine) + 1), channel));
}

Rgb TextureImage::color(Vec2 st, Filter filter, const ImageFootprint& footprint,
                        float anisotropy) const {
    return filtered<Rgb>(st, filter, footprint, anisotropy, Channel::automatic);
}

float TextureImage::value(Vec2 st, Filter filter, const ImageFootprint& footprint, float anisotropy,
                          Channel channel) const {
    return filtered<float>(st, filter, footprint, anisotropy, channel);
}

}  // namespace covtrace
