/// The image of a goniometric or a projection light: a factor on its intensity, by direction.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/transform.h"
#include "light/spot_cone.h"
#include "light/texels.h"
#include "scene/scene_description.h"

namespace covtrace {

class LightImage {
  public:
    /// The image of a goniometric light: square and equal-area, with light space's y as the pole,
    /// as pbrt-v4 has it. It is grey: each texel is the mean of its channels. Throws Error(scene)
    /// at `where` for images that can't be read or aren't square, Error(limit) for those too large
    /// for the memory that is left.
    static LightImage goniometric(const std::filesystem::path& file,
                                  const Transform& light_to_world, const SourceLocation& where,
                                  Warnings& warnings);
    /// A slide in the plane z = 1 of light space, its first row at +y, `fov` degrees along its
    /// shorter side. Throws Error(scene) at `where` for images that can't be read, Error(limit) for
    /// those too large for the memory that is left.
    static LightImage slide(const std::filesystem::path& file, float fov,
                            const Transform& light_to_world, const SourceLocation& where,
                            Warnings& warnings);

    /// The value of the texel that the world direction w (unit, away from the light) falls into;
    /// black beside a slide.
    Rgb operator()(Vec3 w) const;
    /// Integral of the image, times the factor of a goniometric light's cone, if there is one, over
    /// all directions, by solid angle.
    Rgb integral(const SpotCone* cone = nullptr) const;
    /// Whether this is the image of a projection light.
    bool is_slide() const { return half_size_.x > 0; }
    /// Cosine of the angle between a slide's axis and its corners; means nothing for other images.
    float cos_corner() const;

    int width() const { return width_; }
    int height() const { return height_; }
    /// The texels, linear Rec.709, row by row from the top.
    const std::vector<Rgb>& texels() const { return *texels_; }
    /// The place in the image that a world direction falls on, in [0, 1]^2 from the left and the
    /// top; empty beside a slide.
    std::optional<Vec2> place(Vec3 w) const;

  private:
    static LightImage read(const std::filesystem::path& file, LightChannels channels,
                           const Transform& light_to_world, const SourceLocation& where,
                           Warnings& warnings);
    LightImage(const LightTexels& image, const Transform& light_to_world);
    Rgb texel(Vec2 place) const;

    Transform world_to_light_;
    int width_ = 0, height_ = 0;
    std::shared_ptr<const std::vector<Rgb>> texels_;
    Vec2 half_size_;  // of a slide in its plane z = 1 of light space; 0 for other images
};

}  // namespace covtrace
