/// Values of a scene's parts that can be changed after it was read.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <string>
#include <vector>

#include "scene/scene_description.h"

namespace covtrace::python {

namespace py = pybind11;

/// A value of a scene that can be changed, by the name that pbrt's files have for it. Numbers and
/// colours stand for themselves; textures can be read where they are constant, and replaced.
struct Slot {
    std::string name;
    std::function<py::object()> get;
    std::function<void(const py::object&)> set;
};

/// The values of a part that lives as long as they do, and its scene.
std::vector<Slot> slots_of(SceneDescription& scene, MaterialDescription& material);
std::vector<Slot> slots_of(SceneDescription& scene, LightDescription& light);
std::vector<Slot> slots_of(SceneDescription& scene, AreaLightDescription& light);
/// Only what changes the picture of this kind of camera.
std::vector<Slot> slots_of(SceneDescription& scene, CameraDescription& camera);

}  // namespace covtrace::python
