/// The parts of the Python module `covtrace._covtrace`.
#pragma once

#include <pybind11/pybind11.h>

namespace covtrace::python {

/// Our errors as Python exceptions, with file, line and column.
void bind_errors(pybind11::module_& module);
/// Images: named layers as numpy views, reading, writing, comparing.
void bind_image(pybind11::module_& module);
/// Scenes and rendering.
void bind_render(pybind11::module_& module);
/// The operators of the covariance library on arrays.
void bind_covariance(pybind11::module_& module);

}  // namespace covtrace::python
