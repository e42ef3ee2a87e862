/// Spectral responses of the digital cameras that pbrt-v4 knows by name.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace covtrace {

struct SensorCurves {
    std::string_view name;
    /// Responses of red, green and blue at 380, 390, ... 720 nm, relative to the largest of green,
    /// in units of 1/10000; the end values go on outside, as in pbrt-v4.
    std::array<std::array<uint16_t, 35>, 3> values;
};

/// The camera of this name, such as "canon_eos_5d_mkiv"; null for others, "cie1931" among them.
const SensorCurves* find_sensor(std::string_view name);
/// Names of all sensors and "cie1931", for messages.
std::vector<std::string> sensor_names();

}  // namespace covtrace
