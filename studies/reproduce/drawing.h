/// A picture that is described before it is drawn: images, lines, ellipses and text in one
/// coordinate system, x right and y down, in units of output pixels. It can be written as SVG,
/// where lines and text stay lines and text, and as pixels.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/vec.h"
#include "covariance/covariance.hpp"

namespace covtrace::reproduce {

/// Pixels of 8-bit display values, row by row from the top.
struct Picture {
    Picture() = default;
    Picture(int w, int h) : width(w), height(h), rgb(size_t(w) * size_t(h) * 3, 0) {}
    int width = 0, height = 0;
    std::vector<uint8_t> rgb;
};

/// Colour in display values, 0 to 255.
struct Ink {
    uint8_t r = 0, g = 0, b = 0;
    constexpr bool operator==(const Ink&) const = default;
};
inline constexpr Ink kBlack{0, 0, 0}, kRed{214, 52, 40}, kOrange{255, 168, 0}, kCyan{0, 214, 230};

enum class Anchor { start, middle, end };

class Drawing {
  public:
    Drawing(int width, int height) : width_(width), height_(height) {}

    /// Adds a picture, whose pixels become squares of `scale` units.
    void image(Picture picture, float x, float y, float scale);
    void fill(float x, float y, float width, float height, Ink ink);
    void frame(float x, float y, float width, float height, Ink ink, float stroke);
    void line(Vec2 from, Vec2 to, Ink ink, float stroke);
    /// Adds the ellipse p^T C^-1 p = 1 around (x, y), C in units².
    void ellipse(float x, float y, const covariance::Sym2<float>& c, Ink ink, float stroke);
    /// Adds text from (x, y), which is on the base line. `size`: height of a capital letter in
    /// units.
    void text(float x, float y, float size, const std::string& text, Ink ink = kBlack,
              Anchor anchor = Anchor::start);

    /// An <svg> element that holds its images as data; any text is safe in it.
    std::string svg() const;
    Picture pixels() const;

  private:
    struct ImageItem {
        std::shared_ptr<const Picture> picture;
        float x, y, scale;
    };
    struct FillItem {
        float x, y, width, height;
        Ink ink;
    };
    struct StrokeItem {
        std::vector<Vec2> points;
        bool closed;
        Ink ink;
        float stroke;
    };
    struct TextItem {
        float x, y, size;
        std::string text;
        Ink ink;
        Anchor anchor;
    };
    using Item = std::variant<ImageItem, FillItem, StrokeItem, TextItem>;

    int width_, height_;
    std::vector<Item> items_;
};

/// The text with what HTML and SVG would take for markup replaced.
std::string escaped(const std::string& text);

}  // namespace covtrace::reproduce
