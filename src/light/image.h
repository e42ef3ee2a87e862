/// The image that a goniometric or a projection light sends out, by direction.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/transform.h"
#include "light/texels.h"
#include "scene/scene_description.h"
#include "texture/image_spectrum.h"

namespace covtrace {

class LightImage {
  public:
    /// The image of a goniometric light: square and equal-area, with light space's y as the pole,
    /// as pbrt-v4 has it. Grey: each texel is the mean of its channels. Throws Error(scene) at
    /// `where` for images that can't be read or aren't square.
    static LightImage goniometric(const std::filesystem::path& file,
                                  const Transform& light_to_world, const SourceLocation& where,
                                  Warnings& warnings);
    /// A slide in the plane z = 1 of light space, its first row at +y, `fov` degrees along its
    /// shorter side. Throws Error(scene) at `where` for images that can't be read.
    static LightImage slide(const std::filesystem::path& file, float fov,
                            const Transform& light_to_world, const SourceLocation& where,
                            Warnings& warnings);

    /// The value of the texel that the world direction w (unit, away from the light) falls into;
    /// black beside a slide.
    Rgb operator()(Vec3 w) const;
    /// Integral of the image over all directions, by solid angle.
    Rgb integral() const;
    bool is_slide() const { return half_size_.x > 0; }
    /// Cosine of the angle between a slide's axis and its corners.
    float cos_corner() const;

    /// Measures the image, and for a slide its borders against the dark; once. Not thread-safe.
    void prepare_spectrum();
    /// Second moments of the angular amplitude spectrum around the world direction `frame.z`, which
    /// points away from the light, in the frame's x and y, (cycles per radian)^2. Zero beside a
    /// slide and before `prepare_spectrum`.
    SpatialCovariance2 spectrum(const Frame& frame) const;

  private:
    static LightImage read(const std::filesystem::path& file, LightChannels channels,
                           const Transform& light_to_world, const SourceLocation& where,
                           Warnings& warnings);
    LightImage(const LightTexels& image, const Transform& light_to_world);
    Rgb texel(Vec2 place) const;
    /// The place in the image, in [0, 1]^2, that a world direction falls on; empty beside a slide.
    std::optional<Vec2> place(Vec3 w) const;
    /// Derivative of `place` by a rotation of w towards the unit vector `axis`, per radian.
    Vec2 place_per_radian(Vec3 w, Vec3 axis) const;

    Transform world_to_light_;
    int width_ = 0, height_ = 0;
    std::shared_ptr<const std::vector<Rgb>> texels_;
    Vec2 half_size_;  // of a slide
    std::shared_ptr<const ImageSpectrum> spectrum_;
    // Black margin around the image as `spectrum_` has measured it, in parts of the image.
    Vec2 margin_;
};

}  // namespace covtrace
