/// An image as radiance over all directions: lookup, importance sampling, density.
///
/// Light space has z as the pole. Equal-area maps are square (see equal_area.h) and constant within
/// a texel, as pbrt-v4 has them; lat-long maps are twice as wide as high, with u = phi / (2 pi),
/// phi = atan2(y, x) from +x towards +y, and v = theta / pi from +z at the top row's edge down to
/// -z, as pbrt-v4's `imgtool makeequiarea` reads them, and interpolated between texels.
///
/// Directions are sampled with a density proportional to what the image has (mean of the channels)
/// above kLeftOut of its mean, as BSDFs find the rest as well (Karlik, Sik, Vevoda, Skrivan and
/// Krivanek 2019, "MIS compensation"); exactly so on equal-area maps and up to the sine of the
/// polar angle between rows on lat-long ones. A sun of one texel costs no more samples than a plain
/// sky.
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/error.h"
#include "core/huge_pages.h"
#include "core/vec.h"
#include "light/table_cdf.h"
#include "light/weight.h"

namespace covtrace {

class EnvironmentMap {
  public:
    enum class Layout { equal_area, lat_long };
    /// Part of the map's mean that no directions are drawn for. With all of it left out, maps that
    /// are nearly even would have samples for their few brighter texels only; the error over
    /// several maps is in docs/decisions/0074.
    static constexpr float kLeftOut = 0.8f;

    /// Reads an image; integers are taken as sRGB-encoded, grey as all channels alike, negative and
    /// NaN texels as black. Throws Error(scene) at `where` if the file can't be read or is neither
    /// square nor 2:1; warns where its colour space is not known.
    static EnvironmentMap read(const std::filesystem::path& file, const SourceLocation& where,
                               Warnings& warnings);
    /// Makes a map of texels, row by row from the top, finite and not negative; height == width or
    /// width / 2.
    EnvironmentMap(const std::vector<Rgb>& texels, int width, int height);

    Layout layout() const { return layout_; }
    int width() const { return width_; }
    int height() const { return height_; }

    /// Radiance from the unit direction w in light space.
    Rgb radiance(Vec3 w) const { return look(w).radiance; }
    /// A unit direction with density `pdf`, for u in [0, 1)^2. Not for black maps.
    Vec3 sample(Vec2 u) const;
    /// A draw of `sample` in three steps: `begin_draw`, `choose_texel`, `direction`. Each of the
    /// first two ends with a request to memory, which takes as long as hundreds of instructions: a
    /// caller that does something else meanwhile does not wait for it.
    struct Draw {
        Vec2 u;
        size_t row = 0, column = 0;
    };
    Draw begin_draw(Vec2 u) const;
    void choose_texel(Draw& draw) const;
    Vec3 direction(const Draw& draw) const;
    /// Density of `sample` per solid angle.
    float pdf(Vec3 w) const { return look(w).pdf; }
    /// Radiance and density of one direction, from the same texels.
    struct Sight {
        Rgb radiance;
        float pdf = 0;
    };
    Sight look(Vec3 w) const;
    /// Asks for the memory that `look` reads for a direction.
    void prefetch(Vec3 w) const;

    /// Mean radiance over the sphere.
    Rgb mean() const { return mean_; }
    /// The part of the mean radiance that directions are drawn for.
    float drawn_share() const { return drawn_share_; }
    /// Irradiance of a surface that faces +z.
    Rgb irradiance_from_above() const;

  private:
    EnvironmentMap(int width, int height);
    Vec2 to_square(Vec3 w) const;
    const Rgb& nearest_texel(Vec2 uv) const;
    Sight nearest(Vec2 uv) const;
    Sight interpolated(Vec2 uv, float polar_sine) const;
    Vec3 to_direction(Vec2 uv) const;
    /// The texel (x, y), with x in [-1, width] and y in [-1, height]: the map has a margin of one
    /// texel.
    const Rgb& texel(int x, int y) const {
        return texels_[static_cast<size_t>(y + 1) * static_cast<size_t>(width_ + 2) +
                       static_cast<size_t>(x + 1)];
    }
    /// The part of a radiance that directions are drawn for: what it has above kLeftOut of the
    /// mean.
    float drawn(Rgb c) const { return std::max(0.0f, choice_weight(c) - left_out_); }
    /// The weight at a texel's centre that the sampling density is proportional to.
    float weight(int x, int y) const {
        return drawn(texel(x, y)) * row_sine_[static_cast<size_t>(y + 1)];
    }
    float solid_angle(int y) const;  // of one texel of the row
    /// Fills the map from texels[i], the i-th row by row from the top.
    template <typename Texels>
    void build(const Texels& texels);
    template <typename Texels>
    void set_texels(const Texels& texels);
    void set_means();
    void build_distribution();

    /// Texels row by row with one more on every side, which on lat-long maps is what lies beyond
    /// the edge.
    HugePageVector<Rgb> texels_;
    int width_, height_;
    Layout layout_ = Layout::equal_area;
    /// Sine of the polar angle at the rows' centres, with a row more at both ends; 1 on equal-area
    /// maps.
    std::vector<float> row_sine_;
    TableCdf columns_;  // of each row
    TableCdf rows_;
    float left_out_ = 0;
    float density_ =
        0;  ///< per solid angle, of a weight of 1 where the sine of the polar angle is 1
    Rgb mean_;
    float drawn_share_ = 1;
};

}  // namespace covtrace
