"""Shader node trees as pbrt-v4 materials; docs/guide/blender.md has the table."""

import math

import numpy as np

from .baking import Baker, Surface
from .export_sockets import PLAIN_MAPPING, SocketReader, Value
from .export_textures import TextureFiles


def numbers(values):
    return " ".join(f"{v:.9g}" for v in values)


def eta_of_reflectance(reflectance):
    """The index of refraction of what reflects so much at the normal."""
    root = math.sqrt(min(max(reflectance, 0.0), 0.9))
    return (1 + root) / (1 - root)


def either(inputs, *names):
    """The socket by the first of its names that this Blender has: version 4.0 renamed some."""
    return next((inputs[name] for name in names if name in inputs), None)


# Features of Principled that are left out: names of the socket, and the value at which it changes
# nothing.
LEFT_OUT = ((("Subsurface Weight", "Subsurface"), 0), (("Sheen Weight", "Sheen"), 0), (("Coat Weight", "Clearcoat"), 0),
            (("Anisotropic",), 0), (("Diffuse Roughness",), 0), (("Thin Film Thickness",), 0))


class Emission:
    def __init__(self, radiance, texture=None):
        self.radiance, self.texture = radiance, texture


class MaterialExporter(SocketReader):
    """Writes textures and materials into `out`, each once; `material(m)` returns what shapes need."""

    def __init__(self, out, folder, warn):
        self.out, self.warn = out, warn
        self.files = TextureFiles(folder)
        self.baker = Baker(self.files.source)
        self.known, self.of_objects = {}, set()
        self.count = 0

    def material(self, material, object_name="", surface_of=lambda material_name: Surface()):
        """(pbrt name, Emission or None, alpha parameter text, names of the UV maps that it reads; "" is the mesh's).

        object_name: the object that it is on, for what hangs on it. surface_of(name of the material): its Surface there.
        """
        name = material.name_full if material else None
        key = (name, object_name if name in self.of_objects else None)
        if key not in self.known:
            self.surface, self.hangs_on_object = surface_of(name), False
            exported = self._export(material)
            if self.hangs_on_object:
                self.of_objects.add(name)
                key = (name, object_name)
            self.known[key] = exported
        return self.known[key]

    # -- text

    def _texture(self, kind, value, treat=lambda v: v, key=""):
        """Declares a texture of an image and returns its name."""
        file = self.files.write(value.image, (value.key(), kind, key),
                                lambda pixels: treat(value.apply(pixels)))
        name = f"texture {self.count}"
        self.count += 1
        su, sv, du, dv = value.mapping
        self.out.write(f'Texture "{name}" "{kind}" "imagemap" "string filename" "{file}" '
                       f'"string encoding" "linear" "float uscale" {su:.9g} "float vscale" {sv:.9g} '
                       f'"float udelta" {du:.9g} "float vdelta" {dv:.9g} "string filter" "{value.filter}" '
                       f'"string wrap" "{value.wrap}"\n')
        return name

    def _colour(self, parameter, value):
        if value.image:
            return f'"texture {parameter}" "{self._texture("spectrum", value)}"'
        rgb = np.clip(np.array(value.constant, dtype=float), 0, 1)
        return f'"rgb {parameter}" [{numbers(rgb)}]'

    def _number(self, parameter, value, treat=lambda v: v, key=""):
        if value.image:
            return f'"texture {parameter}" "{self._texture("float", value, treat, key)}"'
        return f'"float {parameter}" {float(treat(np.array(value.constant))):.9g}'

    def _make(self, kind, parameters):
        name = f"material {self.count}"
        self.count += 1
        self.out.write(f'MakeNamedMaterial "{name}" "string type" "{kind}" {" ".join(parameters)}\n')
        return name

    def _mix(self, first, second, amount):
        """Share `amount` of the second one."""
        if not amount.image:
            share = min(max(float(amount.constant), 0.0), 1.0)
            if share == 0:
                return first
            if share == 1:
                return second
        return self._make("mix", [f'"string materials" ["{first}" "{second}"]', self._number("amount", amount)])

    # -- shaders

    def _export(self, material):
        self.name = material.name if material else "none"
        if material is None or not material.use_nodes or not material.node_tree:
            colour = tuple(material.diffuse_color)[:3] if material else (0.8, 0.8, 0.8)
            return self._make("diffuse", [self._colour("reflectance", Value(colour))]), None, "", ()
        self.emission, self.alpha, self.uv_maps = None, "", []
        output = material.node_tree.get_output_node("CYCLES")
        for name in ("Volume", "Displacement"):
            if output and output.inputs[name].is_linked:
                self.warn(f"material '{self.name}': {name} is not supported and left out")
        node, _ = self._linked(output.inputs["Surface"]) if output else (None, None)
        if node is None:
            return self._make("diffuse", ['"rgb reflectance" [0 0 0]']), None, "", ()
        return self._shader(node), self.emission, self.alpha, tuple(self.uv_maps)

    def _shader(self, node):
        known = {"BSDF_PRINCIPLED": self._principled, "BSDF_DIFFUSE": self._diffuse, "BSDF_GLOSSY": self._glossy,
                 "BSDF_GLASS": self._glass, "BSDF_REFRACTION": self._glass, "BSDF_TRANSLUCENT": self._translucent,
                 "EMISSION": self._emission, "MIX_SHADER": self._mix_shader, "ADD_SHADER": self._add_shader}
        if node.type in known:
            return known[node.type](node)
        self.warn(f"material '{self.name}': shader '{node.name}' is not supported; grey takes its place")
        return self._make("diffuse", ['"rgb reflectance" [0.5 0.5 0.5]'])

    def _input_shader(self, socket):
        node, _ = self._linked(socket)
        return self._shader(node) if node else self._make("diffuse", ['"rgb reflectance" [0 0 0]'])

    def _roughness(self, value):
        """Blender's roughness squared is the width alpha of GGX."""
        return [self._number("roughness", value, lambda r: np.maximum(r, 0) ** 2, "squared"), '"bool remaproughness" false']

    def _normal_map(self, node):
        source, _ = self._linked(node.inputs["Normal"])
        if source is None:
            return []
        if source.type == "NORMAL_MAP" and source.space == "TANGENT":
            value = self._value(source.inputs["Color"])
            strength = self._plain(source.inputs["Strength"])
            if source.uv_map and source.uv_map not in self.uv_maps:
                self.uv_maps.append(source.uv_map)
            if value.image:
                def scaled(colour):
                    # Cycles blends from the flat normal.
                    flat = np.array([0.5, 0.5, 1.0], dtype=np.float32)
                    return flat + (colour - flat) * strength
                file = self.files.write(value.image, ("normal", strength), lambda p: scaled(value.apply(p)))
                if not value.is_plainly_placed():
                    self.warn(f"material '{self.name}': a normal map is used as it lies, unscaled and interpolated")
                return [f'"string normalmap" "{file}"']
        self.warn(f"material '{self.name}': only tangent space normal maps change normals")
        return []

    def _diffuse(self, node):
        return self._make("diffuse", [self._colour("reflectance", self._value(node.inputs["Color"])),
                                      *self._normal_map(node)])

    def _metal(self, colour, roughness, normal):
        return self._make("conductor", [self._colour("reflectance", colour), *self._roughness(roughness), *normal])

    def _glossy(self, node):
        rough = Value(0.0) if getattr(node, "distribution", "") == "SHARP" else self._value(node.inputs["Roughness"], True)
        return self._metal(self._value(node.inputs["Color"]), rough, self._normal_map(node))

    def _clear(self, colour, roughness, eta, normal):
        return self._make("dielectric", [f'"float eta" {max(eta, 1.0001):.9g}',
                                         self._colour("transmittance", colour), *self._roughness(roughness), *normal])

    def _glass(self, node):
        return self._clear(self._value(node.inputs["Color"]), self._value(node.inputs["Roughness"], True),
                           self._plain(node.inputs["IOR"]), self._normal_map(node))

    def _translucent(self, node):
        return self._make("diffusetransmission", ['"rgb reflectance" [0 0 0]',
                                                  self._colour("transmittance", self._value(node.inputs["Color"]))])

    def _emit(self, colour, strength):
        if colour.image:
            if not colour.is_plainly_placed():
                self.warn(f"material '{self.name}': an image that shines is used as it lies, unscaled and interpolated")
            name = self.files.write_emission(colour.image, colour.key(), colour.apply)
            self.emission = Emission((strength,) * 3, name)
        elif max(colour.constant) * strength > 0:
            self.emission = Emission(tuple(c * strength for c in colour.constant))

    def _emission(self, node):
        self._emit(self._value(node.inputs["Color"]), self._plain(node.inputs["Strength"]))
        return self._make("diffuse", ['"rgb reflectance" [0 0 0]'])

    def _mix_shader(self, node):
        amount = self._value(node.inputs[0], True)
        first, second = (self._linked(node.inputs[i])[0] for i in (1, 2))
        if first and first.type == "BSDF_TRANSPARENT":
            self.alpha = self._number("alpha", amount)
            return self._input_shader(node.inputs[2])
        if second and second.type == "BSDF_TRANSPARENT":
            self.alpha = self._number("alpha", amount.inverse())
            return self._input_shader(node.inputs[1])
        if "EMISSION" in (n.type for n in (first, second) if n):
            self.warn(f"material '{self.name}': emission inside a mixture is not weakened by it")
        return self._mix(self._input_shader(node.inputs[1]), self._input_shader(node.inputs[2]), amount)

    def _add_shader(self, node):
        nodes = [self._linked(node.inputs[i])[0] for i in (0, 1)]
        emitters = [n for n in nodes if n and n.type == "EMISSION"]
        others = [n for n in nodes if n and n.type != "EMISSION"]
        for emitter in emitters:
            self._emission(emitter)
        if len(others) == 1:
            return self._shader(others[0])
        if not others:
            return self._make("diffuse", ['"rgb reflectance" [0 0 0]'])
        self.warn(f"material '{self.name}': a sum of two surfaces is rendered as their mean")
        return self._mix(self._shader(others[0]), self._shader(others[1]), Value(0.5))

    def _tell_left_out(self, inputs):
        """Warns of the features of Principled that are left out."""
        left_out = [(either(inputs, *names), without) for names, without in LEFT_OUT]
        tint = inputs["Specular Tint"]  # a colour since Blender 4.0, and white without effect
        left_out.append((tint, 1 if hasattr(tint.default_value, "__len__") else 0))
        for socket, without in left_out:
            if socket is None:
                continue
            values = np.ravel(socket.default_value)[:3]
            if socket.is_linked or any(value != without for value in values):
                self.warn(f"material '{self.name}': Principled's {socket.name} is not supported and left out")

    def _reflectance(self, inputs):
        """The reflectance of Principled's coat at the normal."""
        if "Specular" in inputs:
            return 0.08 * self._plain(inputs["Specular"])
        # The index and this level tell the reflectance since Blender 4.0; a level of 0.5 changes
        # nothing.
        eta = max(self._plain(inputs["IOR"]), 1e-3)
        return ((eta - 1) / (eta + 1)) ** 2 * 2 * self._plain(inputs["Specular IOR Level"])

    def _principled(self, node):
        get = node.inputs
        base, roughness = self._value(get["Base Color"]), self._value(get["Roughness"], True)
        metallic = self._value(get["Metallic"], True)
        transmission = self._value(either(get, "Transmission Weight", "Transmission"), True)
        normal = self._normal_map(node)
        self._tell_left_out(get)
        self._emit(self._value(either(get, "Emission Color", "Emission")), self._plain(get["Emission Strength"]))
        alpha = self._value(get["Alpha"], True)
        if alpha.image or alpha.constant < 1:
            self.alpha = self._number("alpha", alpha)

        def is_constant(value, number):
            return not value.image and value.constant == number

        parts = []
        if not is_constant(metallic, 1):
            if is_constant(transmission, 1):
                parts.append(self._clear(base, roughness, self._plain(get["IOR"]), normal))
            else:
                eta = eta_of_reflectance(self._reflectance(get))
                coated = self._make("coateddiffuse", [
                    self._colour("reflectance", base), *self._roughness(roughness),
                    f'"float eta" {max(eta, 1.0001):.9g}', '"bool reflectsthroughcoat" true', *normal])
                if not is_constant(transmission, 0):
                    coated = self._mix(coated, self._clear(base, roughness, self._plain(get["IOR"]), normal),
                                       transmission)
                parts.append(coated)
        if not is_constant(metallic, 0):
            parts.append(self._metal(base, roughness, normal))
        return parts[0] if len(parts) == 1 else self._mix(parts[0], parts[1], metallic)
