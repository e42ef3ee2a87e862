/// Measured reflectances of the colour checker, a chart of 24 patches that cameras are calibrated
/// with.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace covtrace {

/// Reflectances at 380, 390, ... 730 nm, in thousandths; the end values go on outside, as in pbrt-v4.
using ChartReflectance = std::array<uint16_t, 36>;
std::span<const ChartReflectance> chart_reflectances();

}  // namespace covtrace
