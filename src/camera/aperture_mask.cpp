#include "camera/aperture_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "light/texels.h"

namespace covtrace {

namespace {

constexpr int kResolution = 256;  // of the built-in shapes, as in pbrt

/// Whether a polygon winds around a point.
bool holds(std::span<const Vec2> polygon, Vec2 p) {
    int turns = 0;
    for (size_t i = 0; i < polygon.size(); ++i) {
        const Vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        const float side = (b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y);
        if (a.y <= p.y && b.y > p.y && side > 0) ++turns;
        if (a.y > p.y && b.y <= p.y && side < 0) --turns;
    }
    return turns != 0;
}

/// Corners at these radii in turn, `count` of them around the centre, the first one `start` from
/// the x axis.
std::vector<Vec2> corners(int count, std::span<const float> radii, float start) {
    std::vector<Vec2> all;
    for (int i = 0; i < count; ++i) {
        const float phi = start + 2 * kPi * float(i) / float(count);
        all.push_back(radii[size_t(i) % radii.size()] * Vec2{std::cos(phi), std::sin(phi)});
    }
    return all;
}

/// A built-in shape in the square [-1, 1]^2, y up; sizes and angles are pbrt's.
float built_in(ApertureShape::Kind kind, Vec2 p) {
    static const float inner = std::cos(kPi * 72 / 180) / std::cos(kPi * 36 / 180);
    static const std::vector<Vec2> pentagon = corners(5, std::array{0.8f}, kPi / 2);
    static const std::vector<Vec2> star = corners(10, std::array{inner, 1.0f}, 0);
    switch (kind) {
        case ApertureShape::Kind::gaussian:
            return std::max(0.0f, std::exp(-dot(p, p)) - std::exp(-1.0f));
        case ApertureShape::Kind::square:
            return std::abs(p.x) < 0.5f && std::abs(p.y) < 0.5f ? 1.0f : 0.0f;
        case ApertureShape::Kind::pentagon:
            return holds(pentagon, p) ? 1.0f : 0.0f;
        case ApertureShape::Kind::star:
            return holds(star, p) ? 1.0f : 0.0f;
        case ApertureShape::Kind::round:
        case ApertureShape::Kind::image:
            break;
    }
    return 1;
}

}  // namespace

ApertureMask::ApertureMask(const ApertureShape& shape) {
    if (shape.kind == ApertureShape::Kind::round) return;
    // Rows go down in pictures, and y goes up behind the stop, where everything is upside down
    if (shape.kind == ApertureShape::Kind::image) {
        Warnings unknown_colours;  // shares are no colours
        const LightTexels image =
            read_light_texels(shape.image, LightChannels::factors, shape.where, unknown_colours);
        width_ = image.width();
        height_ = image.height();
        for (int y = height_ - 1; y >= 0; --y)
            for (int x = 0; x < width_; ++x) {
                const Rgb t = image[size_t(y) * size_t(width_) + size_t(x)];
                texels_.push_back((t.r + t.g + t.b) / 3);
            }
    } else {
        width_ = height_ = kResolution;
        const auto centre = [](int i) { return (2 * float(i) + 1) / float(kResolution) - 1; };
        for (int y = kResolution - 1; y >= 0; --y)
            for (int x = 0; x < kResolution; ++x)
                texels_.push_back(built_in(shape.kind, {centre(x), centre(y)}));
    }
    const double sum = std::accumulate(texels_.begin(), texels_.end(), 0.0);
    if (!(sum > 0))
        throw Error(ErrorKind::scene, shape.where,
                    "the aperture '" + shape.image.string() + "' lets no light through");
    const auto scale = float(kPi / 4 * double(texels_.size()) / sum);
    reach_ = 0;
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            float& t = texels_[size_t(y) * size_t(width_) + size_t(x)];
            t *= scale;
            // Values between texels reach one texel farther
            const float across =
                            std::abs(2 * (float(x) + 0.5f) / float(width_) - 1) + 2 / float(width_),
                        up = std::abs(2 * (float(y) + 0.5f) / float(height_) - 1) +
                             2 / float(height_);
            if (t > 0) reach_ = std::max(reach_, length(Vec2{across, up}));
        }
}

float ApertureMask::operator()(Vec2 place) const {
    if (texels_.empty()) return dot(place, place) <= 1 ? 1.0f : 0.0f;
    if (!(std::abs(place.x) <= 1 && std::abs(place.y) <= 1)) return 0;
    const float x = (place.x + 1) / 2 * float(width_) - 0.5f,
                y = (place.y + 1) / 2 * float(height_) - 0.5f;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const auto texel = [&](int i, int j) {
        const bool inside = i >= 0 && i < width_ && j >= 0 && j < height_;
        return inside ? texels_[size_t(j) * size_t(width_) + size_t(i)] : 0.0f;
    };
    const float u = x - float(x0), v = y - float(y0);
    return (1 - v) * ((1 - u) * texel(x0, y0) + u * texel(x0 + 1, y0)) +
           v * ((1 - u) * texel(x0, y0 + 1) + u * texel(x0 + 1, y0 + 1));
}

}  // namespace covtrace
