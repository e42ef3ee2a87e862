#include "light/image.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/memory_limit.h"

#include "light/equal_area.h"

namespace covtrace {

LightImage::LightImage(const LightTexels& image, const Transform& light_to_world)
    : world_to_light_(light_to_world.inverse()),
      width_(image.width()),
      height_(image.height()),
      texels_(std::make_shared<const std::vector<Rgb>>(image.all())) {}

LightImage LightImage::read(const std::filesystem::path& file, LightChannels channels,
                            const Transform& light_to_world, const SourceLocation& where,
                            Warnings& warnings) {
    const LightTexels texels = read_light_texels(file, channels, where, warnings);
    const MemoryReservation room(texels.size() * sizeof(Rgb),
                                 "the texels of '" + file.string() + "'", where);
    return made_of(file, where, [&] { return LightImage(texels, light_to_world); });
}

LightImage LightImage::goniometric(const std::filesystem::path& file,
                                   const Transform& light_to_world, const SourceLocation& where,
                                   Warnings& warnings) {
    LightImage light = read(file, LightChannels::factors, light_to_world, where, warnings);
    if (light.width_ != light.height_)
        throw Error(ErrorKind::scene, where,
                    "image \"" + file.string() + "\" of a goniometric light is " +
                        std::to_string(light.width_) + " x " + std::to_string(light.height_) +
                        " pixels; expected a square (equal-area map)");
    std::vector<Rgb> grey(*light.texels_);
    for (Rgb& t : grey) t = Rgb((t.r + t.g + t.b) * (1.0f / 3));
    light.texels_ = std::make_shared<const std::vector<Rgb>>(std::move(grey));
    return light;
}

LightImage LightImage::slide(const std::filesystem::path& file, float fov,
                             const Transform& light_to_world, const SourceLocation& where,
                             Warnings& warnings) {
    LightImage light = read(file, LightChannels::colour, light_to_world, where, warnings);
    const float shorter = std::tan(fov * kPi / 360);
    const float aspect = static_cast<float>(light.width_) / static_cast<float>(light.height_);
    light.half_size_ =
        aspect > 1 ? Vec2{shorter * aspect, shorter} : Vec2{shorter, shorter / aspect};
    return light;
}

Rgb LightImage::texel(Vec2 place) const {
    const auto index = [](float x, int n) {
        // A place that is not a number becomes the first texel: its sample is rejected later.
        return x > 0 ? std::min(static_cast<size_t>(x * static_cast<float>(n)), size_t(n) - 1) : 0;
    };
    return (
        *texels_)[index(place.y, height_) * static_cast<size_t>(width_) + index(place.x, width_)];
}

std::optional<Vec2> LightImage::place(Vec3 w) const {
    const Vec3 local = normalize(world_to_light_.vector(w));
    // The pole of a goniometric light is y, that of the equal-area map z.
    if (!is_slide()) return equal_area_sphere_to_square({local.x, local.z, local.y});
    constexpr float kNearest = 1e-3f;  // as in pbrt-v4: nothing shines to the side or back
    if (local.z < kNearest) return std::nullopt;
    const Vec2 place{0.5f * (1 + local.x / (local.z * half_size_.x)),
                     0.5f * (1 - local.y / (local.z * half_size_.y))};
    const bool inside = place.x >= 0 && place.x <= 1 && place.y >= 0 && place.y <= 1;
    return inside ? std::optional(place) : std::nullopt;
}

Rgb LightImage::operator()(Vec3 w) const {
    const std::optional<Vec2> at = place(w);
    return at ? texel(*at) : Rgb();
}

Rgb LightImage::integral(const SpotCone* cone) const {
    const Transform light_to_world = world_to_light_.inverse();
    double sum[3] = {};
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            double solid_angle = 4 * double(kPi) / (double(width_) * height_);
            if (is_slide()) {
                // The solid angle of a texel is cos^3 times its area in the plane at distance 1.
                const double sx = ((2 * x + 1.0) / width_ - 1) * half_size_.x,
                             sy = ((2 * y + 1.0) / height_ - 1) * half_size_.y;
                solid_angle = 4.0 * half_size_.x * half_size_.y / (double(width_) * height_) /
                              std::pow(1 + sx * sx + sy * sy, 1.5);
            }
            if (cone) {
                const Vec3 w = equal_area_square_to_sphere(
                    {(float(x) + 0.5f) / float(width_), (float(y) + 0.5f) / float(height_)});
                const Vec3 world = normalize(light_to_world.vector({w.x, w.z, w.y}));
                solid_angle *= double(cone->falloff(world));
            }
            const Rgb t = (*texels_)[static_cast<size_t>(y) * static_cast<size_t>(width_) +
                                     static_cast<size_t>(x)];
            sum[0] += t.r * solid_angle;
            sum[1] += t.g * solid_angle;
            sum[2] += t.b * solid_angle;
        }
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

float LightImage::cos_corner() const {
    return 1 / std::sqrt(1 + half_size_.x * half_size_.x + half_size_.y * half_size_.y);
}

}  // namespace covtrace
