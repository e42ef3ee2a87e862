/// The image that a goniometric or a projection light sends out, by direction.
#pragma once

#include <memory>
#include <vector>

#include "core/transform.h"
#include "scene/scene_description.h"

namespace covtrace {

class LightImage {
  public:
    /// Square and equal-area, light space's y as the pole, as pbrt-v4 has it; grey: the mean of the
    /// channels. Throws Error(scene) at `where` for images that can't be read or aren't square.
    static LightImage goniometric(const std::filesystem::path& file,
                                  const Transform& light_to_world, const SourceLocation& where);
    /// A slide in the plane z = 1 of light space, its first row at +y, `fov` degrees along its
    /// shorter side. Throws Error(scene) at `where` for images that can't be read.
    static LightImage slide(const std::filesystem::path& file, float fov,
                            const Transform& light_to_world, const SourceLocation& where);

    /// Of the texel that the world direction w (unit, away from the light) falls into; black beside
    /// a slide.
    Rgb operator()(Vec3 w) const;
    /// Over all directions, by solid angle.
    Rgb integral() const;
    bool is_slide() const { return half_size_.x > 0; }
    /// Cosine of the angle between a slide's axis and its corners.
    float cos_corner() const;

  private:
    LightImage(const std::filesystem::path& file, const Transform& light_to_world,
               const SourceLocation& where);
    Rgb texel(Vec2 place) const;

    Transform world_to_light_;
    int width_ = 0, height_ = 0;
    std::shared_ptr<const std::vector<Rgb>> texels_;
    Vec2 half_size_;  // of a slide
};

}  // namespace covtrace
