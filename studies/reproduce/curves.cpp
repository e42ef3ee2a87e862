#include "reproduce/curves.h"

#include <fmt/format.h>

#include <algorithm>

namespace covtrace::reproduce {

void draw_curves(Sheet& sheet, int column, int row, const std::string& title,
                 const std::string& quantity, Vec2 least, Vec2 most,
                 const std::vector<Curve>& curves) {
    constexpr Ink kGrey{150, 150, 150};
    const Vec2 corner = sheet.corner(column, row);
    const float width = sheet.width(), height = sheet.height();
    const auto place = [&](Vec2 p) {
        const float y = std::clamp((p.y - least.y) / (most.y - least.y), 0.0f, 1.0f);
        return Vec2{corner.x + width * (p.x - least.x) / (most.x - least.x),
                    corner.y + height * (1 - y)};
    };
    Drawing& drawing = sheet.drawing;
    drawing.text(corner.x, corner.y - 6, 8, title);
    drawing.frame(corner.x, corner.y, width, height, kGrey, 1);
    const float below = corner.y + height + 12;
    drawing.text(corner.x, below, 6, fmt::format("{:.3g}", least.x));
    drawing.text(corner.x + 0.5f * width, below, 6.5f, quantity, kBlack, Anchor::middle);
    drawing.text(corner.x + width, below, 6, fmt::format("{:.3g}", most.x), kBlack, Anchor::end);
    float label = corner.y + 14;
    for (const Curve& curve : curves) {
        for (size_t i = 1; i < curve.points.size(); ++i)
            drawing.line(place(curve.points[i - 1]), place(curve.points[i]), curve.ink, 1.6f);
        drawing.text(corner.x + width - 6, label, 6.5f, curve.label, curve.ink, Anchor::end);
        label += 12;
    }
}

}  // namespace covtrace::reproduce
