#include "scene_values.h"

#include <pybind11/numpy.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "options.h"

namespace covtrace::python {

namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

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

bool is_fisheye(const CameraDescription& camera) {
    using Mapping = CameraDescription::Mapping;
    return camera.kind == CameraDescription::Kind::spherical &&
           (camera.mapping == Mapping::equidistant || camera.mapping == Mapping::equisolid);
}

}  // namespace

std::vector<Slot> slots_of(SceneDescription& scene, MaterialDescription& m) {
    std::vector<Slot> slots;
    if (m.mix)
        slots.push_back(texture_slot(scene, "amount", m.mix->amount, TextureUse::number));
    else
        std::visit(MaterialSlots{scene, slots}, m.value);
    return slots;
}

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
    using Kind = CameraDescription::Kind;
    std::vector<Slot> slots;
    // The field of view of a traced lens follows from its surfaces
    if (camera.kind == Kind::perspective && !camera.lens)
        slots.push_back(number_slot("fov", camera.fov, 0.001, 179.999));
    if (is_fisheye(camera)) slots.push_back(number_slot("fov", camera.fov, 0.001, 360));
    if (camera.kind == Kind::spherical) return slots;
    slots.push_back(number_slot("lensradius", camera.lens_radius));
    slots.push_back(number_slot("focaldistance", camera.focal_distance, 1e-6));
    return slots;
}

}  // namespace covtrace::python
