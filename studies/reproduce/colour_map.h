/// Colour maps: values as colours, and the legend that says which is which.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "reproduce/drawing.h"

namespace covtrace::reproduce {

/// A logarithmic scale from `least` to `most`, dark blue over green to pale yellow; values beyond
/// an end have its colour. The lightness rises all the way, so that it can be printed in grey.
struct ColourMap {
    float least, most;
    std::string quantity;  ///< quantity with its unit, for the legend
    Ink operator()(float value) const;
};

/// A map from the 2nd to the 98th percentile of the positive values, over at least a factor of 10.
ColourMap map_for(std::span<const float> values, std::string quantity);

Picture coloured(std::span<const float> values, int width, int height, const ColourMap& map);

/// Draws the bar with ticks at 1, 2, 5 x 10^k into a box of this width and kLegendHeight.
inline constexpr float kLegendHeight = 36;
void draw_legend(Drawing& drawing, const ColourMap& map, float x, float y, float width);

}  // namespace covtrace::reproduce
