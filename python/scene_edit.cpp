#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bindings.h"
#include "core/hash.h"
#include "options.h"
#include "scene/scene_description.h"
#include "scene/scene_files.h"
#include "scene_values.h"

namespace covtrace::python {

namespace py = pybind11;

namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Names of the models, in the order of MaterialDescription's variant.
constexpr auto kMaterialKinds = std::to_array<const char*>(
    {"diffuse", "conductor", "dielectric", "coateddiffuse", "diffusetransmission",
     "coatedconductor", "thindielectric", "interface", "measured", "unlit", "hair", "subsurface"});

constexpr std::array<const char*, 6> kLightKinds{"point",      "spot",    "goniometric",
                                                 "projection", "distant", "infinite"};

/// Calls use(part) for the part of the scene that a kind and an index name.
template <typename Use>
auto with_part(SceneDescription& s, const std::string& kind, size_t index, const Use& use) {
    const auto at = [&](auto& list) -> auto& {
        if (index >= list.size())
            throw py::index_error("the scene has " + std::to_string(list.size()) + " of these");
        return list[index];
    };
    if (kind == "material") return use(at(s.materials));
    if (kind == "light") return use(at(s.lights));
    if (kind == "area_light") return use(at(s.area_lights));
    return use(s.camera);
}

py::dict values(SceneDescription& scene, const std::string& kind, size_t index) {
    py::dict result;
    with_part(scene, kind, index, [&](auto& part) {
        for (const Slot& slot : slots_of(scene, part)) result[py::str(slot.name)] = slot.get();
    });
    return result;
}

/// The transform of a camera, light, shape or instance.
AnimatedTransform& moving(SceneDescription& s, const std::string& kind, size_t index) {
    if (kind == "camera") return s.camera.camera_to_world;
    if (index >= (kind == "shape" ? s.shapes.size() : s.instances.size()))
        throw py::index_error("the scene has no such " + kind);
    return kind == "shape" ? s.shapes[index].object_to_world : s.instances[index].instance_to_world;
}

Transform transform_of(const Array& values) {
    require(values.ndim() == 2 && values.shape(0) == 4 && values.shape(1) == 4,
            "a transform: expected an array of the shape (4, 4)");
    Matrix4 matrix;
    std::copy_n(values.data(), 16, &matrix.m[0][0]);
    const auto transform = Transform::from_matrix(matrix);
    require(transform.has_value(), "a transform: expected a matrix that can be inverted");
    return *transform;
}

Array array_of(const Transform& t) {
    Array values({4, 4});
    std::copy_n(&t.matrix().m[0][0], 16, values.mutable_data());
    return values;
}

/// The matrices at the start and the end; the second is none where nothing moves.
py::tuple transforms(SceneDescription& s, const std::string& kind, size_t index) {
    if (kind == "light") {
        if (index >= s.lights.size()) throw py::index_error("the scene has no such light");
        return py::make_tuple(array_of(s.lights[index].light_to_world), py::none());
    }
    const AnimatedTransform& t = moving(s, kind, index);
    return py::make_tuple(array_of(t.start()),
                          t.is_animated() ? py::object(array_of(t.end())) : py::none());
}

/// Numbers that tell one transform from another.
std::vector<double> numbers_of(const Transform& t) {
    const double* first = &t.matrix().m[0][0];
    return {first, first + 16};
}

std::vector<double> numbers_of(const AnimatedTransform& t) {
    std::vector<double> numbers = numbers_of(t.start());
    if (!t.is_animated()) return numbers;
    const std::vector<double> end = numbers_of(t.end());
    numbers.insert(numbers.end(), end.begin(), end.end());
    numbers.push_back(t.start_time());
    numbers.push_back(t.end_time());
    return numbers;
}

/// Hash of all that can be changed about a part.
uint64_t hash_of_part(SceneDescription& s, const std::string& kind, size_t index) {
    std::string text = kind + " " + std::to_string(index);
    std::vector<double> place;
    if (kind == "light")
        place = numbers_of(s.lights.at(index).light_to_world);
    else if (kind == "camera" || kind == "shape" || kind == "instance")
        place = numbers_of(moving(s, kind, index));
    text.append(reinterpret_cast<const char*>(place.data()), place.size() * sizeof(double));
    if (kind == "shape")
        text += std::to_string(s.shapes[index].material);
    else if (kind != "instance")
        text += std::string(py::repr(values(s, kind, index)));
    return hash_of(text);
}

/// Changes a part, and the scene's hash with it, by which films know their scene. What the part was
/// is taken out of the hash and what it is put in, so that the hash follows from the values: in
/// whatever order they were set, and the file's own again where they are.
template <typename Change>
void change_part(SceneDescription& s, const std::string& kind, size_t index, const Change& change) {
    const uint64_t before = hash_of_part(s, kind, index);
    change();
    s.content_hash ^= before ^ hash_of_part(s, kind, index);
}

void set_value(SceneDescription& scene, const std::string& kind, size_t index,
               const std::string& name, const py::object& value) {
    with_part(scene, kind, index, [&](auto& part) {
        std::string names;
        for (const Slot& slot : slots_of(scene, part)) {
            if (slot.name == name) return change_part(scene, kind, index, [&] { slot.set(value); });
            names += (names.empty() ? "" : ", ") + slot.name;
        }
        throw py::key_error("there is no value '" + name + "'; there are " +
                            (names.empty() ? "none" : names));
    });
}

void set_transforms(SceneDescription& s, const std::string& kind, size_t index, const Array& start,
                    const std::optional<Array>& end) {
    const Transform first = transform_of(start);
    change_part(s, kind, index, [&] {
        if (kind == "light") {
            require(!end, "lights do not move");
            s.lights[index].light_to_world = first;
            return;
        }
        if (kind == "camera") s.no_camera.reset();
        AnimatedTransform& t = moving(s, kind, index);
        t = end ? AnimatedTransform(first, s.camera.shutter_open, transform_of(*end),
                                    s.camera.shutter_close)
                : AnimatedTransform(first);
    });
}

void set_material(SceneDescription& s, size_t shape, size_t material) {
    if (shape >= s.shapes.size() || material >= s.materials.size())
        throw py::index_error("the scene has no such shape or material");
    change_part(s, "shape", shape, [&] { s.shapes[shape].material = MaterialId(material); });
}

/// Removes a light. Those behind it move up, so that the hash goes on from what it was.
void remove_light(SceneDescription& s, size_t index) {
    if (index >= s.lights.size()) throw py::index_error("the scene has no such light");
    s.content_hash = hash_combine(s.content_hash, s.lights.size(), index);
    s.lights.erase(s.lights.begin() + std::ptrdiff_t(index));
}

/// Names and kinds of the materials, kinds of the lights, materials of the shapes.
py::dict parts(const SceneDescription& s) {
    py::list materials, lights, shapes;
    for (const MaterialDescription& m : s.materials)
        materials.append(py::make_tuple(m.name, m.mix ? "mix" : kMaterialKinds[m.value.index()]));
    for (const LightDescription& l : s.lights) lights.append(kLightKinds[l.value.index()]);
    for (const ShapeDescription& shape : s.shapes) shapes.append(shape.material);
    py::dict result;
    result["materials"] = materials;
    result["lights"] = lights;
    result["area_lights"] = s.area_lights.size();
    result["shapes"] = shapes;
    result["instances"] = s.instances.size();
    return result;
}

}  // namespace

void bind_scene_edit(SceneClass& scene) {
    scene
        .def("copy",
             [](const SceneDescription& s) { return std::make_shared<SceneDescription>(s); })
        .def("parts", &parts)
        .def("material_of_shape",
             [](const SceneDescription& s, size_t i) { return s.shapes.at(i).material; })
        .def("values", &values)
        .def("set_value", &set_value)
        .def("transforms", &transforms)
        .def("set_transforms", &set_transforms, py::arg("kind"), py::arg("index"), py::arg("start"),
             py::arg("end") = py::none())
        .def("set_material", &set_material)
        .def("remove_light", &remove_light);
}

}  // namespace covtrace::python
