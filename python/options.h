/// The keywords of covtrace.render as options of the renderer. Wrong ones throw Error(usage).
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "core/enum_names.h"
#include "core/error.h"
#include "denoiser/find_denoiser.h"
#include "render/options.h"
#include "render/overrides.h"
#include "render/preset.h"

namespace covtrace::python {

namespace py = pybind11;

inline void require(bool holds, const std::string& message) {
    if (!holds) throw Error(ErrorKind::usage, message);
}

/// The value options[name] as T. Throws Error(usage) that says what was expected.
template <typename T>
T value_of(const py::dict& options, const char* name, const char* expected) {
    const py::object value = options[name];
    try {
        return value.cast<T>();
    } catch (const py::cast_error&) {
        throw Error(ErrorKind::usage, std::string(name) + " is " +
                                          py::repr(value).cast<std::string>() + "; expected " +
                                          expected);
    }
}

/// The value that the text options[name] stands for. Throws Error(usage) that lists all values.
template <NamedEnum Enum>
Enum choice(const py::dict& options, const char* name) {
    const std::string expected = "one of " + listed_names<Enum>(", ", "'");
    const auto text = value_of<std::string>(options, name, expected.c_str());
    if (const auto value = value_named<Enum>(text)) return *value;
    throw Error(ErrorKind::usage, std::string(name) + " is '" + text + "'; expected " + expected);
}

inline bool is_given(const py::dict& options, const char* name) {
    return !options[name].is_none();
}

/// The number of worker threads, 0 for all cores.
inline int thread_count(const py::dict& options) {
    const int threads = value_of<int>(options, "threads", "a whole number");
    require(threads >= 0 && threads <= 4096, "threads must be from 0 to 4096");
    return threads;
}

/// A finite number above zero and not below `least`.
template <typename T>
std::optional<T> positive(const py::dict& options, const char* name, double least = 0) {
    if (!is_given(options, name)) return std::nullopt;
    const T value = value_of<T>(options, name, "a number");
    require(value > 0 && std::isfinite(value), std::string(name) + " must be greater than 0");
    require(double(value) >= least, std::string(name) + " is too small to reckon with");
    return value;
}

RenderOptions render_options(const py::dict& o);
std::optional<Preset> preset(const py::dict& o);
std::optional<DenoiserQuality> denoiser_quality(const py::dict& o);
/// The search for the denoiser; its folders are those around the module's own file.
DenoiserSearch denoiser_search(const py::dict& o);
SceneOverrides scene_overrides(const py::dict& o);

/// Refuses a shutter that is no begin and a later end.
std::array<float, 2> checked_shutter(const std::array<float, 2>& shutter);

}  // namespace covtrace::python
