/// Panels of curves: values over an axis, with both axes' ends labelled.
#pragma once

#include "reproduce/panels.h"

namespace covtrace::reproduce {

struct Curve {
    std::string label;
    Ink ink;
    std::vector<Vec2> points;  ///< in the units of the axes
};

/// Draws curves into a panel of a sheet. The axes go from `least` to `most`; a curve is cut at the
/// panel's upper and lower edge. `quantity`: what the horizontal axis means, with its unit.
void draw_curves(Sheet& sheet, int column, int row, const std::string& title,
                 const std::string& quantity, Vec2 least, Vec2 most,
                 const std::vector<Curve>& curves);

}  // namespace covtrace::reproduce
