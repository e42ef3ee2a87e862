/// Panels of a picture to look at: images and logarithmic maps with their legends, side by side.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/vec.h"

namespace covtrace {

/// Maps a positive value to a linear colour, piecewise linear in its logarithm between `stops` (in
/// rising order), constant beyond.
struct LogColours {
    struct Stop {
        float value;
        Rgb colour;
    };
    std::vector<Stop> stops;
    Rgb operator()(float value) const;
};

/// A row of panels, which have the same size in pixels and are magnified alike.
class PanelPicture {
  public:
    PanelPicture(int width, int height) : width_(width), height_(height) {}
    /// Adds a panel of width * height linear colours.
    void add(std::vector<Rgb> colours) { panels_.push_back({std::move(colours), {}, {}}); }
    /// Adds a panel with a legend below that shows `scale` and the numbers `ticks`.
    void add(std::vector<Rgb> colours, LogColours scale, std::vector<float> ticks) {
        panels_.push_back({std::move(colours), std::move(scale), std::move(ticks)});
    }
    /// Writes the picture. Throws Error(io).
    void write_png(const std::filesystem::path& file) const;

  private:
    struct Panel {
        std::vector<Rgb> colours;
        LogColours scale;
        std::vector<float> ticks;
    };
    int width_, height_;
    std::vector<Panel> panels_;
};

}  // namespace covtrace
