/// The parts of the Python module `covtrace._covtrace`.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "scene/scene_description.h"

namespace covtrace::python {

/// Our errors as Python exceptions, with file, line and column.
void bind_errors(pybind11::module_& module);
/// Images: named layers as numpy views, reading, writing, comparing.
void bind_image(pybind11::module_& module);
/// Films of shards, joined.
void bind_films(pybind11::module_& module);
/// The reconstruction of images of other renderers.
void bind_denoise(pybind11::module_& module);
/// Scenes and rendering.
void bind_render(pybind11::module_& module);
using SharedScene = std::shared_ptr<SceneDescription>;
using SceneClass = pybind11::class_<SceneDescription, SharedScene>;
/// The parts of a scene that can be changed after it was read from its file.
void bind_scene_edit(SceneClass& scene);
/// The operators of the covariance library on arrays.
void bind_covariance(pybind11::module_& module);

}  // namespace covtrace::python
