#include "light/image_spectrum.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace covtrace {

LightImageSpectrum::LightImageSpectrum(const LightImage& image) : image_(&image) {
    // A slide ends in the dark, so the image is measured with a black margin of an eighth of its
    // size, at least as wide as the widest derivative.
    const auto border = [&image](int n) { return image.is_slide() ? std::max(4, n / 8) : 0; };
    const int left = border(image.width()), top = border(image.height());
    const int width = image.width() + 2 * left, height = image.height() + 2 * top;
    std::vector<float> values(static_cast<size_t>(width) * static_cast<size_t>(height), 0.0f);
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            values[static_cast<size_t>(y + top) * static_cast<size_t>(width) +
                   static_cast<size_t>(x + left)] =
                luminance(
                    image.texels()[static_cast<size_t>(y) * static_cast<size_t>(image.width()) +
                                   static_cast<size_t>(x)]);
    margin_ = {static_cast<float>(left) / static_cast<float>(image.width()),
               static_cast<float>(top) / static_cast<float>(image.height())};
    spectrum_ = ImageSpectrum(values, width, height, ImageSpectrum::Wrap::clamp);
}

Vec2 LightImageSpectrum::place_per_radian(Vec3 w, Vec3 axis) const {
    constexpr float kStep = 1e-3f;
    const std::optional<Vec2> a = image_->place(normalize(w - axis * kStep)),
                              b = image_->place(normalize(w + axis * kStep));
    // The derivative across a border of the octahedral square is taken as the map's mean scale; at
    // the rim of a slide it is zero.
    const bool is_slide = image_->is_slide();
    const float mean = is_slide ? 0.0f : 1 / std::sqrt(4 * kPi);
    const bool crosses_border = !is_slide && a && b && length(*b - *a) > 0.1f;
    if (!a || !b || crosses_border) return {mean, mean};
    return (*b - *a) * (0.5f / kStep);
}

SpatialCovariance2 LightImageSpectrum::at(const Frame& frame) const {
    const std::optional<Vec2> place = image_->place(frame.z);
    if (!place) return {};
    const float s_scale = 1 / (1 + 2 * margin_.x), t_scale = 1 / (1 + 2 * margin_.y);
    const SpatialCovariance2 c =
        spectrum_.at((place->x + margin_.x) * s_scale, (place->y + margin_.y) * t_scale);
    const Vec2 dx = place_per_radian(frame.z, frame.x), dy = place_per_radian(frame.z, frame.y);
    const auto form = [&](Vec2 a, Vec2 b) {
        const Vec2 p{a.x * s_scale, a.y * t_scale}, q{b.x * s_scale, b.y * t_scale};
        return c.ss * p.x * q.x + c.st * (p.x * q.y + p.y * q.x) + c.tt * p.y * q.y;
    };
    return {form(dx, dx), form(dx, dy), form(dy, dy)};
}

}  // namespace covtrace
