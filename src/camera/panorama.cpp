#include "camera/panorama.h"

#include <algorithm>
#include <cmath>

#include "light/equal_area.h"

namespace covtrace {

namespace {

using Mapping = CameraDescription::Mapping;

/// Coordinates inside the square for ones beyond it: the equal-area map goes on beyond an edge at
/// the edge's other half.
Vec2 wrap_equal_area(Vec2 uv) {
    if (uv.x < 0 || uv.x > 1) uv = {uv.x < 0 ? -uv.x : 2 - uv.x, 1 - uv.y};
    if (uv.y < 0 || uv.y > 1) uv = {1 - uv.x, uv.y < 0 ? -uv.y : 2 - uv.y};
    return uv;
}

}  // namespace

Panorama::Panorama(const CameraDescription& d, int width, int height, Vec2 origin, Vec2 per_pixel)
    : mapping_(d.mapping),
      sphere_part_(d.sphere_part),
      half_fov_(d.fov * kPi / 360),
      size_{static_cast<float>(width), static_cast<float>(height)},
      origin_(origin),
      per_pixel_(per_pixel) {}

bool Panorama::is_fisheye() const {
    return mapping_ == Mapping::equidistant || mapping_ == Mapping::equisolid;
}

float Panorama::angle(float radius) const {
    if (mapping_ == Mapping::equidistant) return radius * half_fov_;
    return 2 * std::asin(std::min(1.0f, radius * std::sin(half_fov_ / 2)));
}

float Panorama::radius(float angle) const {
    if (mapping_ == Mapping::equidistant) return angle / half_fov_;
    return std::sin(angle / 2) / std::sin(half_fov_ / 2);
}

Vec3 Panorama::direction(Vec2 film) const {
    if (is_fisheye()) {
        const Vec2 p{origin_.x + film.x * per_pixel_.x, origin_.y + film.y * per_pixel_.y};
        const float r = length(p), theta = angle(r);
        const float across = r > 0 ? std::sin(theta) / r : 0;
        return {p.x * across, p.y * across, std::cos(theta)};
    }
    const Vec2 uv{film.x / size_.x, film.y / size_.y};
    if (mapping_ == Mapping::equal_area) {
        const Vec3 w = equal_area_square_to_sphere(wrap_equal_area(uv));
        return {w.x, w.z, w.y};
    }
    const auto& [left, right, top, bottom] = sphere_part_;
    const float theta = kPi * std::lerp(top, bottom, uv.y);
    const float phi = 2 * kPi * std::lerp(left, right, uv.x);
    return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}

Vec2 Panorama::film(Vec3 w) const {
    if (is_fisheye()) {
        const float across = std::sqrt(w.x * w.x + w.y * w.y);
        const float r = radius(std::atan2(across, w.z));
        const Vec2 p = across > 0 ? Vec2{w.x, w.y} * (r / across) : Vec2{r, 0};
        return {(p.x - origin_.x) / per_pixel_.x, (p.y - origin_.y) / per_pixel_.y};
    }
    Vec2 uv;
    if (mapping_ == Mapping::equal_area) {
        uv = equal_area_sphere_to_square({w.x, w.z, w.y});
    } else {
        const auto& [left, right, top, bottom] = sphere_part_;
        const float turn = std::atan2(w.z, w.x) / (2 * kPi);
        // Several turns mean this direction; the film shows one
        const float shown = turn + std::ceil(left - turn);
        const float polar = std::acos(std::clamp(w.y, -1.0f, 1.0f)) / kPi;
        uv = {(shown - left) / (right - left), (polar - top) / (bottom - top)};
    }
    return {uv.x * size_.x, uv.y * size_.y};
}

bool Panorama::sees(Vec2 film) const {
    if (!is_fisheye()) return true;
    return length(Vec2{origin_.x + film.x * per_pixel_.x, origin_.y + film.y * per_pixel_.y}) <= 1;
}

float Panorama::pixel_angle() const {
    if (is_fisheye()) return half_fov_ * per_pixel_.x;
    return kPi * (sphere_part_[3] - sphere_part_[2]) / size_.y;
}

}  // namespace covtrace
