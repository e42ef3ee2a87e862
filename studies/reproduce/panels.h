/// Panels: the parts that figures are put together from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "image/image.h"
#include "reconstruction/filter_field.h"
#include "reproduce/colour_map.h"
#include "reproduce/drawing.h"

namespace covtrace::reproduce {

/// The image as write_png shows it: exposure 1, sRGB; `dim` is multiplied to the display values.
Picture display(const Image& image, float dim = 1);

/// The layer prefix + "xx", "xy", "yy" of an image, one matrix per pixel.
std::vector<covariance::Sym2<float>> matrices(const Image& image, const std::string& prefix);

/// Filters without limits: (4 pi² c² S)^-1 of the image's `spectrum` layer. Pixels whose spectrum
/// is singular get a filter of `widest` pixels in that direction.
std::vector<covariance::Sym2<float>> filters_of_spectrum(const Image& image, float c,
                                                         float widest = 1e4f);

/// Sizes of filters in pixels: the geometric mean deviation det(C)^(1/4).
std::vector<float> sizes_of(const std::vector<covariance::Sym2<float>>& filters);

/// Relative error |I - R| of the luminance over R + 0.01, per pixel.
std::vector<float> relative_error(const Image& image, const Image& reference);

/// Panels in rows under their titles, all of one size, with a heading per row at most.
class Sheet {
  public:
    /// Lays the sheet out. `panel`: pixels of one picture; `scale`: units per pixel; `legends`:
    /// rows that need room for a legend below.
    Sheet(std::array<int, 2> panel, float scale, int columns, int rows,
          const std::vector<bool>& legends = {});
    Drawing drawing;
    /// Upper left corner of a panel.
    Vec2 corner(int column, int row) const;
    /// Pixels of one picture.
    std::array<int, 2> panel() const { return panel_; }
    float width() const { return scale_ * float(panel_[0]); }
    float height() const { return scale_ * float(panel_[1]); }

    void picture(int column, int row, const std::string& title, Picture picture);
    /// Adds a map of values with its legend.
    void map(int column, int row, const std::string& title, const std::vector<float>& values,
             const ColourMap& map);
    /// Adds ellipses where the filters reach `deviations` standard deviations, at about `across`
    /// places in a row; none that would overlap another or leave the panel.
    void ellipses(int column, int row, const std::vector<covariance::Sym2<float>>& filters,
                  int across, float deviations, Ink ink);
    /// Adds a frame around pixels.
    void mark(int column, int row, const PixelBounds& bounds, Ink ink);

  private:
    std::array<int, 2> panel_;
    float scale_;
    std::vector<float> row_top_;
};

/// A crop, magnified by `crops`, which has one column per image.
struct Crop {
    PixelBounds bounds;
    Ink ink;
};
Drawing crops(const std::vector<std::pair<std::string, const Image*>>& images,
              const std::vector<Crop>& crops, float width);

/// The pixels in `x0, y0, x1, y1`, shares of the image's sides; at least one pixel.
PixelBounds part(const Image& image, std::array<double, 4> shares);

}  // namespace covtrace::reproduce
