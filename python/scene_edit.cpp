#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
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

namespace covtrace::python {

namespace py = pybind11;

namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A value of a scene that can be changed, by the name that pbrt's files have for it. Numbers and
/// colours stand for themselves; textures can be read where they are constant, and replaced.
struct Slot {
    std::string name;
    std::function<py::object()> get;
    std::function<void(const py::object&)> set;
};

std::vector<double> numbers_of(const std::string& name, const py::object& value, size_t count) {
    const Array array = Array::ensure(value);
    require(array && (size_t(array.size()) == count || array.size() == 1),
            name + ": expected a number" + (count > 1 ? " or three of them" : ""));
    std::vector<double> numbers(array.data(), array.data() + array.size());
    numbers.resize(count, numbers[0]);
    for (double v : numbers)
        require(std::isfinite(float(v)) && v >= 0, name + ": expected finite numbers from 0 on");
    return numbers;
}

Rgb colour_of(const std::string& name, const py::object& value) {
    const std::vector<double> v = numbers_of(name, value, 3);
    return {float(v[0]), float(v[1]), float(v[2])};
}

Slot number_slot(const std::string& name, float& number, double least = 0,
                 double most = kInfinity) {
    return {name, [&number] { return py::object(py::float_(number)); },
            [=, &number](const py::object& value) {
                const double v = numbers_of(name, value, 1)[0];
                require(v >= least && v <= most, name + ": expected a number from " +
                                                     std::to_string(least) + " to " +
                                                     std::to_string(most));
                number = float(v);
            }};
}

Slot colour_slot(const std::string& name, Rgb& colour) {
    return {name, [&colour] { return py::object(py::make_tuple(colour.r, colour.g, colour.b)); },
            [&colour, name](const py::object& value) { colour = colour_of(name, value); }};
}

enum class TextureUse { number, colour, share };  ///< share: a colour of at most 1

Slot texture_slot(SceneDescription& scene, const std::string& name, TextureId& id, TextureUse use) {
    const auto get = [&scene, &id, use]() -> py::object {
        if (id < 0) return py::none();
        const auto* constant = std::get_if<ConstantTexture>(&scene.textures[size_t(id)].value);
        if (!constant) return py::none();
        const Rgb v = constant->value;
        return use == TextureUse::number ? py::object(py::float_(v.r))
                                         : py::object(py::make_tuple(v.r, v.g, v.b));
    };
    const auto set = [&scene, &id, name, use](const py::object& value) {
        const Rgb colour = use == TextureUse::number ? Rgb(float(numbers_of(name, value, 1)[0]))
                                                     : colour_of(name, value);
        require(use != TextureUse::share || std::max({colour.r, colour.g, colour.b}) <= 1,
                name + ": expected numbers up to 1");
        id = TextureId(scene.textures.size());
        scene.textures.push_back({{}, use != TextureUse::number, ConstantTexture{colour}, {}});
    };
    return {name, get, set};
}

/// The changeable values of a material model.
struct MaterialSlots {
    SceneDescription& scene;
    std::vector<Slot>& slots;

    void texture(const char* name, TextureId& id, TextureUse use) {
        slots.push_back(texture_slot(scene, name, id, use));
    }
    void roughness(TextureId& u, TextureId& v, const std::string& prefix = {}) {
        texture((prefix + "uroughness").c_str(), u, TextureUse::number);
        texture((prefix + "vroughness").c_str(), v, TextureUse::number);
        slots.push_back({prefix + "roughness", slots.back().get,
                         [set_u = slots[slots.size() - 2].set,
                          set_v = slots.back().set](const py::object& value) {
                             set_u(value);
                             set_v(value);
                         }});
    }
    void operator()(DiffuseMaterial& m) {
        texture("reflectance", m.reflectance, TextureUse::share);
    }
    void operator()(ConductorMaterial& m) {
        // A metal has its indices or its reflectance: beside a reflectance they would not count.
        if (m.reflectance < 0) {
            texture("eta", m.eta, TextureUse::colour);
            texture("k", m.k, TextureUse::colour);
        }
        texture("reflectance", m.reflectance, TextureUse::share);
        slots.back().set = [set = slots.back().set, &m](const py::object& value) {
            set(value);
            m.eta = m.k = -1;
        };
        roughness(m.u_roughness, m.v_roughness);
    }
    void operator()(DielectricMaterial& m) {
        slots.push_back(number_slot("eta", m.eta, 0.01, 100));
        texture("transmittance", m.transmittance, TextureUse::share);
        roughness(m.u_roughness, m.v_roughness);
    }
    void operator()(CoatedDiffuseMaterial& m) {
        slots.push_back(number_slot("eta", m.eta, 0.01, 100));
        texture("reflectance", m.reflectance, TextureUse::share);
        roughness(m.u_roughness, m.v_roughness);
    }
    void operator()(SubsurfaceMaterial& m) {
        slots.push_back(number_slot("scale", m.scale, 0, 1e9));
        slots.push_back(number_slot("eta", m.border.eta, 0.01, 100));
        if (m.border.reflectance >= 0) {
            texture("reflectance", m.border.reflectance, TextureUse::share);
            texture("mfp", m.mean_free_path, TextureUse::colour);
        } else {
            texture("sigma_a", m.absorption, TextureUse::colour);
            texture("sigma_s", m.scattering, TextureUse::colour);
        }
        roughness(m.border.u_roughness, m.border.v_roughness);
    }
    void operator()(DiffuseTransmissionMaterial& m) {
        texture("reflectance", m.reflectance, TextureUse::share);
        texture("transmittance", m.transmittance, TextureUse::share);
    }
    void operator()(CoatedConductorMaterial& m) {
        (*this)(m.conductor);
        for (Slot& slot : slots) slot.name = "conductor." + slot.name;
        slots.push_back(number_slot("interface.eta", m.eta, 0.01, 100));
        roughness(m.u_roughness, m.v_roughness, "interface.");
    }
    void operator()(ThinDielectricMaterial& m) {
        slots.push_back(number_slot("eta", m.eta, 0.01, 100));
        texture("transmittance", m.transmittance, TextureUse::share);
    }
    void operator()(InterfaceMaterial&) {}
    void operator()(MeasuredMaterial&) {}
    void operator()(HairMaterial& m) {
        texture("sigma_a", m.absorption, TextureUse::colour);
        texture("reflectance", m.reflectance, TextureUse::share);
        texture("eumelanin", m.eumelanin, TextureUse::number);
        texture("pheomelanin", m.pheomelanin, TextureUse::number);
        texture("beta_m", m.beta_m, TextureUse::share);
        texture("beta_n", m.beta_n, TextureUse::share);
        texture("alpha", m.alpha, TextureUse::number);
        texture("eta", m.eta, TextureUse::number);
    }
    void operator()(UnlitMaterial& m) { texture("colour", m.colour, TextureUse::colour); }
};

/// Names of the models, in the order of MaterialDescription's variant.
constexpr auto kMaterialKinds = std::to_array<const char*>(
    {"diffuse", "conductor", "dielectric", "coateddiffuse", "diffusetransmission",
     "coatedconductor", "thindielectric", "interface", "measured", "unlit", "hair", "subsurface"});

std::vector<Slot> slots_of(SceneDescription& scene, MaterialDescription& m) {
    std::vector<Slot> slots;
    if (m.mix)
        slots.push_back(texture_slot(scene, "amount", m.mix->amount, TextureUse::number));
    else
        std::visit(MaterialSlots{scene, slots}, m.value);
    return slots;
}

constexpr std::array<const char*, 6> kLightKinds{"point",      "spot",    "goniometric",
                                                 "projection", "distant", "infinite"};

std::vector<Slot> slots_of(SceneDescription&, LightDescription& light) {
    std::vector<Slot> slots;
    std::visit(
        [&](auto& l) {
            if constexpr (requires { l.intensity; })
                slots.push_back(colour_slot("I", l.intensity));
            else if constexpr (requires { l.radiance; })
                slots.push_back(colour_slot("L", l.radiance));
            else
                slots.push_back(number_slot("scale", l.scale));
            if constexpr (requires { l.angle; })
                slots.push_back(number_slot("angle", l.angle, 0, 180));
        },
        light.value);
    return slots;
}

std::vector<Slot> slots_of(SceneDescription&, AreaLightDescription& light) {
    return {colour_slot("L", light.radiance)};
}

std::vector<Slot> slots_of(SceneDescription&, CameraDescription& camera) {
    std::vector<Slot> slots{number_slot("lensradius", camera.lens_radius),
                            number_slot("focaldistance", camera.focal_distance, 1e-6)};
    // The field of view of a traced lens follows from its surfaces
    const double widest = camera.kind == CameraDescription::Kind::spherical ? 360 : 179.999;
    if (!camera.lens) slots.insert(slots.begin(), number_slot("fov", camera.fov, 0.001, widest));
    return slots;
}

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
        throw py::key_error("there is no value '" + name + "'; there are " + names);
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
