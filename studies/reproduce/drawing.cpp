#include "reproduce/drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base64.h"
#include "image/image.h"
#include "reproduce/stroke_font.h"

namespace covtrace::reproduce {

namespace {

constexpr float kFontStroke = 0.14f;  // share of the height of capitals

std::string colour(Ink i) {
    return fmt::format("#{:02x}{:02x}{:02x}", i.r, i.g, i.b);
}

std::string data_uri(const Picture& p) {
    const std::string png = encode_png_rgb8(p.rgb, p.width, p.height);
    return "data:image/png;base64," +
           base64({reinterpret_cast<const uint8_t*>(png.data()), png.size()});
}

void blend(Picture& p, int x, int y, Ink ink, float share) {
    if (x < 0 || y < 0 || x >= p.width || y >= p.height) return;
    uint8_t* at = &p.rgb[(size_t(y) * size_t(p.width) + size_t(x)) * 3];
    const uint8_t to[3] = {ink.r, ink.g, ink.b};
    for (int k = 0; k < 3; ++k)
        at[k] = uint8_t(std::lround(float(at[k]) + share * (float(to[k]) - float(at[k]))));
}

float distance_to_segment(Vec2 p, Vec2 a, Vec2 b) {
    const Vec2 d = b - a;
    const float square = dot(d, d);
    const float t = square > 0 ? std::clamp(dot(p - a, d) / square, 0.0f, 1.0f) : 0.0f;
    return length(p - (a + d * t));
}

/// Draws a line with round ends; each pixel gets the largest share that any part of the line
/// covers, so that corners are not darker than the rest.
void stroke(Picture& p, const std::vector<Vec2>& points, bool closed, Ink ink, float width) {
    if (points.empty()) return;
    Vec2 least = points[0], most = points[0];
    for (const Vec2 q : points) {
        least = {std::min(least.x, q.x), std::min(least.y, q.y)};
        most = {std::max(most.x, q.x), std::max(most.y, q.y)};
    }
    const float reach = 0.5f * width + 1;
    const int x0 = std::max(0, int(std::floor(least.x - reach)));
    const int y0 = std::max(0, int(std::floor(least.y - reach)));
    const int x1 = std::min(p.width, int(std::ceil(most.x + reach)));
    const int y1 = std::min(p.height, int(std::ceil(most.y + reach)));
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
            const Vec2 at{float(x) + 0.5f, float(y) + 0.5f};
            float d = length(at - points[0]);
            for (size_t i = 1; i < points.size(); ++i)
                d = std::min(d, distance_to_segment(at, points[i - 1], points[i]));
            if (closed) d = std::min(d, distance_to_segment(at, points.back(), points[0]));
            const float share = std::clamp(0.5f * width + 0.5f - d, 0.0f, 1.0f);
            if (share > 0) blend(p, x, y, ink, std::min(share, std::max(width, 0.3f)));
        }
}

std::string point_list(const std::vector<Vec2>& points) {
    std::string text;
    for (const Vec2 p : points)
        text += fmt::format("{}{:.4g},{:.4g}", text.empty() ? "" : " ", p.x, p.y);
    return text;
}

}  // namespace

std::string escaped(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        switch (c) {
            case '&':
                safe += "&amp;";
                break;
            case '<':
                safe += "&lt;";
                break;
            case '>':
                safe += "&gt;";
                break;
            case '"':
                safe += "&quot;";
                break;
            case '\'':
                safe += "&#39;";
                break;
            default:
                safe += c;
        }
    }
    return safe;
}

void Drawing::image(Picture picture, float x, float y, float scale) {
    items_.push_back(ImageItem{std::make_shared<Picture>(std::move(picture)), x, y, scale});
}

void Drawing::fill(float x, float y, float width, float height, Ink ink) {
    items_.push_back(FillItem{x, y, width, height, ink});
}

void Drawing::frame(float x, float y, float width, float height, Ink ink, float stroke_width) {
    items_.push_back(StrokeItem{{{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}},
                                true,
                                ink,
                                stroke_width});
}

void Drawing::line(Vec2 from, Vec2 to, Ink ink, float stroke_width) {
    items_.push_back(StrokeItem{{from, to}, false, ink, stroke_width});
}

void Drawing::ellipse(float x, float y, const covariance::Sym2<float>& c, Ink ink,
                      float stroke_width) {
    // The Cholesky factor takes the unit circle to the ellipse.
    const float a = std::sqrt(std::max(c.xx, 0.0f));
    const float b = a > 0 ? c.xy / a : 0.0f;
    const float d = std::sqrt(std::max(c.yy - b * b, 0.0f));
    constexpr int kCorners = 40;
    std::vector<Vec2> points;
    for (int i = 0; i < kCorners; ++i) {
        const float t = 2 * kPi * float(i) / kCorners;
        points.push_back({x + a * std::cos(t), y + b * std::cos(t) + d * std::sin(t)});
    }
    items_.push_back(StrokeItem{std::move(points), true, ink, stroke_width});
}

void Drawing::text(float x, float y, float size, const std::string& text, Ink ink, Anchor anchor) {
    items_.push_back(TextItem{x, y, size, text, ink, anchor});
}

std::string Drawing::svg() const {
    std::string s = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
        "height=\"{1}\" role=\"img\" font-family=\"sans-serif\">\n<rect width=\"{0}\" "
        "height=\"{1}\" fill=\"#ffffff\"/>\n",
        width_, height_);
    for (const Item& item : items_) {
        if (const auto* i = std::get_if<ImageItem>(&item)) {
            s += fmt::format(
                "<image x=\"{:.6g}\" y=\"{:.6g}\" width=\"{:.6g}\" height=\"{:.6g}\" "
                "style=\"image-rendering:pixelated\" href=\"{}\"/>\n",
                i->x, i->y, i->scale * float(i->picture->width),
                i->scale * float(i->picture->height), data_uri(*i->picture));
        } else if (const auto* f = std::get_if<FillItem>(&item)) {
            s += fmt::format(
                "<rect x=\"{:.6g}\" y=\"{:.6g}\" width=\"{:.6g}\" height=\"{:.6g}\" "
                "fill=\"{}\"/>\n",
                f->x, f->y, f->width, f->height, colour(f->ink));
        } else if (const auto* l = std::get_if<StrokeItem>(&item)) {
            s += fmt::format(
                "<poly{} points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:.3g}\"/>\n",
                l->closed ? "gon" : "line", point_list(l->points), colour(l->ink), l->stroke);
        } else if (const auto* t = std::get_if<TextItem>(&item)) {
            // Size of a sans-serif font over that of its capitals.
            constexpr float kFontSize = 1.39f;
            s += fmt::format(
                "<text x=\"{:.6g}\" y=\"{:.6g}\" font-size=\"{:.4g}\" fill=\"{}\" "
                "text-anchor=\"{}\">{}</text>\n",
                t->x, t->y, kFontSize * t->size, colour(t->ink),
                t->anchor == Anchor::start    ? "start"
                : t->anchor == Anchor::middle ? "middle"
                                              : "end",
                escaped(t->text));
        }
    }
    return s + "</svg>\n";
}

Picture Drawing::pixels() const {
    Picture p(width_, height_);
    std::fill(p.rgb.begin(), p.rgb.end(), uint8_t(255));
    for (const Item& item : items_) {
        if (const auto* i = std::get_if<ImageItem>(&item)) {
            const auto edge = [&](float at, int k) {
                return int(std::lround(at + i->scale * float(k)));
            };
            for (int v = 0; v < i->picture->height; ++v)
                for (int u = 0; u < i->picture->width; ++u) {
                    const uint8_t* c =
                        &i->picture->rgb[(size_t(v) * size_t(i->picture->width) + size_t(u)) * 3];
                    for (int y = edge(i->y, v); y < edge(i->y, v + 1); ++y)
                        for (int x = edge(i->x, u); x < edge(i->x, u + 1); ++x)
                            blend(p, x, y, {c[0], c[1], c[2]}, 1);
                }
        } else if (const auto* f = std::get_if<FillItem>(&item)) {
            for (int y = int(std::lround(f->y)); y < int(std::lround(f->y + f->height)); ++y)
                for (int x = int(std::lround(f->x)); x < int(std::lround(f->x + f->width)); ++x)
                    blend(p, x, y, f->ink, 1);
        } else if (const auto* l = std::get_if<StrokeItem>(&item)) {
            stroke(p, l->points, l->closed, l->ink, l->stroke);
        } else if (const auto* t = std::get_if<TextItem>(&item)) {
            const float unit = t->size / kCapital;
            const float width = unit * kAdvance * float(letters_in(t->text));
            const float shift = t->anchor == Anchor::start    ? 0
                                : t->anchor == Anchor::middle ? 0.5f * width
                                                              : width;
            for (std::vector<Vec2> line : strokes_of(t->text)) {
                for (Vec2& q : line) q = {t->x - shift + unit * q.x, t->y + unit * q.y};
                stroke(p, line, false, t->ink, kFontStroke * t->size);
            }
        }
    }
    return p;
}

}  // namespace covtrace::reproduce
