#include "reproduce/panels.h"

#include <algorithm>
#include <cmath>

#include "image/color_encoding.h"

namespace covtrace::reproduce {

namespace {

constexpr float kMargin = 8, kTitle = 18, kCapitals = 8;

/// The ellipse p' C^-1 p = 1 around its middle, pixels.
struct Ellipse {
    Vec2 middle;
    covariance::Sym2<float> c;
};

/// Whether two ellipses may overlap: they are apart where what they reach towards each other is
/// less than their distance.
bool overlap(const Ellipse& a, const Ellipse& b) {
    const Vec2 d = a.middle - b.middle;
    const auto reach = [d](const covariance::Sym2<float>& c) {
        return std::sqrt(c.xx * d.x * d.x + 2 * c.xy * d.x * d.y + c.yy * d.y * d.y);
    };
    return reach(a.c) + reach(b.c) > dot(d, d);
}

}  // namespace

Picture display(const Image& image, float dim) {
    Picture p(image.width(), image.height());
    const Channel* channels[3] = {image.find("R"), image.find("G"), image.find("B")};
    for (size_t i = 0; i < image.pixel_count(); ++i)
        for (size_t c = 0; c < 3; ++c)
            p.rgb[3 * i + c] =
                uint8_t(std::lround(dim * float(srgb_encode_8bit(channels[c]->values[i]))));
    return p;
}

std::vector<covariance::Sym2<float>> matrices(const Image& image, const std::string& prefix) {
    const Channel &xx = *image.find(prefix + "xx"), &xy = *image.find(prefix + "xy"),
                  &yy = *image.find(prefix + "yy");
    std::vector<covariance::Sym2<float>> m(image.pixel_count());
    for (size_t i = 0; i < m.size(); ++i) m[i] = {xx.values[i], xy.values[i], yy.values[i]};
    return m;
}

std::vector<covariance::Sym2<float>> filters_of_spectrum(const Image& image, float c,
                                                         float widest) {
    std::vector<covariance::Sym2<float>> filters = matrices(image, "spectrum.");
    for (covariance::Sym2<float>& s : filters)
        s = covariance::filter_covariance(covariance::filter_quadratic(s, c, {1e-3f, widest}));
    return filters;
}

std::vector<float> sizes_of(const std::vector<covariance::Sym2<float>>& filters) {
    std::vector<float> sizes(filters.size());
    for (size_t i = 0; i < sizes.size(); ++i) sizes[i] = covariance::filter_size(filters[i]);
    return sizes;
}

std::vector<float> relative_error(const Image& image, const Image& reference) {
    std::vector<float> error(image.pixel_count());
    for (size_t i = 0; i < error.size(); ++i) {
        const float r = luminance(reference.rgb(i));
        error[i] = std::abs(luminance(image.rgb(i)) - r) / (std::abs(r) + 0.01f);
    }
    return error;
}

Sheet::Sheet(std::array<int, 2> panel, float scale, int columns, int rows,
             const std::vector<bool>& legends)
    : drawing(1, 1), panel_(panel), scale_(scale) {
    float y = kMargin;
    for (int row = 0; row < rows; ++row) {
        row_top_.push_back(y + kTitle);
        y += kTitle + height() + kMargin;
        if (size_t(row) < legends.size() && legends[size_t(row)]) y += kLegendHeight + 4;
    }
    drawing =
        Drawing(int(std::ceil(kMargin + float(columns) * (width() + kMargin))), int(std::ceil(y)));
}

Vec2 Sheet::corner(int column, int row) const {
    return {kMargin + float(column) * (width() + kMargin), row_top_[size_t(row)]};
}

void Sheet::picture(int column, int row, const std::string& title, Picture picture) {
    const Vec2 at = corner(column, row);
    drawing.image(std::move(picture), at.x, at.y, scale_);
    drawing.text(at.x, at.y - 6, kCapitals, title);
}

void Sheet::map(int column, int row, const std::string& title, const std::vector<float>& values,
                const ColourMap& colours) {
    const Vec2 at = corner(column, row);
    picture(column, row, title, coloured(values, panel_[0], panel_[1], colours));
    draw_legend(drawing, colours, at.x, at.y + height(), width());
}

void Sheet::ellipses(int column, int row, const std::vector<covariance::Sym2<float>>& filters,
                     int across, float deviations, Ink ink) {
    const Vec2 at = corner(column, row);
    const float step = float(panel_[0]) / float(across);
    const int down = std::max(1, int(std::lround(float(panel_[1]) / step)));
    std::vector<Ellipse> candidates;
    for (int j = 0; j < down; ++j)
        for (int i = 0; i < across; ++i) {
            const int x = std::min(int((float(i) + 0.5f) * step), panel_[0] - 1);
            const int y =
                std::min(int((float(j) + 0.5f) * float(panel_[1]) / float(down)), panel_[1] - 1);
            const auto& f = filters[size_t(y) * size_t(panel_[0]) + size_t(x)];
            const Ellipse e{{float(x) + 0.5f, float(y) + 0.5f}, deviations * deviations * f};
            // Leave out ellipses that would cross the border of the panel
            const float rx = std::sqrt(e.c.xx), ry = std::sqrt(e.c.yy);
            if (e.middle.x >= rx && e.middle.y >= ry && e.middle.x + rx <= float(panel_[0]) &&
                e.middle.y + ry <= float(panel_[1]))
                candidates.push_back(e);
        }
    // Small ones first: a large one beside them would hide that there is detail.
    std::stable_sort(candidates.begin(), candidates.end(), [](const Ellipse& a, const Ellipse& b) {
        return covariance::det(a.c) < covariance::det(b.c);
    });
    std::vector<Ellipse> drawn;
    for (const Ellipse& e : candidates) {
        if (std::any_of(drawn.begin(), drawn.end(),
                        [&e](const Ellipse& other) { return overlap(e, other); }))
            continue;
        drawn.push_back(e);
        drawing.ellipse(at.x + scale_ * e.middle.x, at.y + scale_ * e.middle.y,
                        scale_ * scale_ * e.c, ink, 1.2f);
    }
}

void Sheet::mark(int column, int row, const PixelBounds& b, Ink ink) {
    const Vec2 at = corner(column, row);
    drawing.frame(at.x + scale_ * float(b.x0), at.y + scale_ * float(b.y0),
                  scale_ * float(b.width()), scale_ * float(b.height()), ink, 2);
}

PixelBounds part(const Image& image, std::array<double, 4> shares) {
    const auto at = [](double share, int size) {
        return std::clamp(int(std::lround(share * size)), 0, size);
    };
    PixelBounds b{at(shares[0], image.width()), at(shares[1], image.height()),
                  at(shares[2], image.width()), at(shares[3], image.height())};
    b.x1 = std::max(b.x1, b.x0 + 1);
    b.y1 = std::max(b.y1, b.y0 + 1);
    return b;
}

Drawing crops(const std::vector<std::pair<std::string, const Image*>>& images,
              const std::vector<Crop>& insets, float width) {
    const float cell = (width - kMargin) / float(images.size()) - kMargin;
    float height = kMargin + kTitle;
    for (const Crop& c : insets)
        height += cell * float(c.bounds.height()) / float(c.bounds.width()) + kMargin;
    Drawing drawing(int(std::ceil(width)), int(std::ceil(height)));
    for (size_t i = 0; i < images.size(); ++i) {
        const float x = kMargin + float(i) * (cell + kMargin);
        float y = kMargin + kTitle;
        drawing.text(x, y - 6, kCapitals, images[i].first);
        for (const Crop& c : insets) {
            const float scale = cell / float(c.bounds.width());
            const float h = scale * float(c.bounds.height());
            drawing.image(display(cropped(*images[i].second, c.bounds)), x, y, scale);
            drawing.frame(x + 1, y + 1, cell - 2, h - 2, c.ink, 2);
            y += h + kMargin;
        }
    }
    return drawing;
}

}  // namespace covtrace::reproduce
