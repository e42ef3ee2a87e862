"""Shader node trees as pbrt-v4 materials; docs/blender.md has the table."""

import math

import numpy as np

from .export_textures import TextureFiles


def numbers(values):
    return " ".join(f"{v:.9g}" for v in values)


def eta_of_specular(specular):
    """Principled's Specular: reflects 8 % of it at the normal."""
    root = math.sqrt(min(0.08 * max(specular, 0.0), 0.9))
    return (1 + root) / (1 - root)


class Value:
    """What a socket gives: a constant, or an image with a treatment."""

    def __init__(self, constant=None, image=None, mapping=None, channel=None, scale=1.0, offset=0.0, filter="bilinear",
                 wrap="repeat"):
        self.constant, self.image, self.mapping, self.channel = constant, image, mapping, channel
        self.scale, self.offset, self.filter, self.wrap = scale, offset, filter, wrap

    def inverse(self, whole=1.0):
        """whole - this."""
        if self.image:
            return Value(image=self.image, mapping=self.mapping, channel=self.channel, scale=-self.scale,
                         offset=whole - self.offset, filter=self.filter, wrap=self.wrap)
        if hasattr(self.constant, "__len__"):
            return Value(tuple(whole - c for c in self.constant))
        return Value(whole - self.constant)

    def is_plainly_placed(self):
        return self.mapping == PLAIN_MAPPING and self.filter == "bilinear" and self.wrap == "repeat"

    def apply(self, pixels):
        """(h, w, 4) to (h, w, 3), or to (h, w) where one number is wanted."""
        if self.channel == "grey":
            values = pixels[..., :3] @ np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)
        elif self.channel is not None:
            values = pixels[..., "RGBA".index(self.channel)]
        else:
            values = pixels[..., :3]
        return values * self.scale + self.offset

    def key(self):
        return (self.channel, self.scale, self.offset)


PLAIN_MAPPING = (1, 1, 0, 0)

# Blender's ways to go on beyond an image, in pbrt's words.
WRAPS = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "black"}


class Emission:
    def __init__(self, radiance, texture=None):
        self.radiance, self.texture = radiance, texture


class MaterialExporter:
    """Writes textures and materials into `out`, each once; `material(m)` returns what shapes need."""

    def __init__(self, out, folder, warn):
        self.out, self.warn = out, warn
        self.files = TextureFiles(folder)
        self.known = {}
        self.count = 0

    def material(self, material):
        """(pbrt name, Emission or None, alpha parameter text, names of the UV maps that it reads; "" is the mesh's)."""
        key = material.name_full if material else None
        if key not in self.known:
            self.known[key] = self._export(material)
        return self.known[key]

    # -- sockets

    def _linked(self, socket):
        """The node and socket that feed it, reroutes passed."""
        while socket.is_linked:
            link = socket.links[0]
            if link.from_node.type != "REROUTE":
                return link.from_node, link.from_socket
            socket = link.from_node.inputs[0]
        return None, None

    def _value(self, socket, grey=False):
        """Value of a socket; what is not understood becomes the socket's own constant, with a warning."""
        node, output = self._linked(socket)
        if node is None:
            return self._constant(socket.default_value, grey)
        value = self._node_value(node, output, grey)
        if value is None:
            self.warn(f"material '{self.name}': node '{node.name}' at '{socket.name}' is not supported; "
                      "the socket's own value is used")
            return self._constant(socket.default_value, grey)
        return value

    def _plain(self, socket):
        """A number where there can be no image; what is linked and no constant is told."""
        value = self._value(socket, True)
        if value.image:
            self.warn(f"material '{self.name}': an image at '{socket.name}' is not supported; the socket's own value is used")
            return float(socket.default_value)
        return float(value.constant)

    def _constant(self, v, grey):
        if hasattr(v, "__len__"):
            v = tuple(v)[:3]
            return Value(0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2] if grey else v)
        return Value(float(v) if grey else (float(v),) * 3)

    def _node_value(self, node, output, grey):
        if node.type == "RGB" or node.type == "VALUE":
            return self._constant(output.default_value, grey)
        if node.type == "TEX_IMAGE" and node.image:
            channel = "A" if output.name == "Alpha" else "grey" if grey else None
            if node.projection != "FLAT":
                self.warn(f"material '{self.name}': the projection of '{node.name}' is not supported; its image lies flat")
            if node.extension not in WRAPS:
                self.warn(f"material '{self.name}': the extension of '{node.name}' is not supported; its image repeats")
            return Value(image=node.image, mapping=self._mapping(node), channel=channel,
                         filter="point" if node.interpolation == "Closest" else "bilinear",
                         wrap=WRAPS.get(node.extension, "repeat"))
        if node.type in ("SEPARATE_COLOR", "SEPRGB") and grey and getattr(node, "mode", "RGB") == "RGB":
            source = self._node_value(*self._linked(node.inputs[0]), False) if node.inputs[0].is_linked else None
            if source and source.image and output.name[:1] in "RGB":
                source.channel = output.name[:1]
                return source
        if node.type == "MATH" and grey and node.operation == "SUBTRACT" and not node.inputs[0].is_linked:
            return self._value(node.inputs[1], True).inverse(node.inputs[0].default_value)
        if node.type == "INVERT" and not node.inputs["Fac"].is_linked and node.inputs["Fac"].default_value == 1:
            return self._value(node.inputs["Color"], grey).inverse()
        return None

    def _is_uv(self, node, output):
        """Whether the node gives texture coordinates of a mesh; notes of which map."""
        if node is None or node.type == "TEX_COORD" and output.name == "UV":
            name = ""
        elif node.type == "UVMAP":
            name = node.uv_map
        else:
            return False
        if name not in self.uv_maps:
            self.uv_maps.append(name)
        return True

    def _mapping(self, node):
        """pbrt's scale and offset of (u, v), from a Mapping node."""
        source, output = self._linked(node.inputs["Vector"])
        if self._is_uv(source, output):
            return PLAIN_MAPPING
        if source.type == "MAPPING" and source.vector_type in ("POINT", "TEXTURE"):
            inner, inner_output = self._linked(source.inputs["Vector"])
            linked = any(source.inputs[name].is_linked for name in ("Rotation", "Location", "Scale"))
            rotation = source.inputs["Rotation"].default_value
            location, scale = source.inputs["Location"].default_value, source.inputs["Scale"].default_value
            if not linked and max(map(abs, rotation)) < 1e-6 and self._is_uv(inner, inner_output):
                if source.vector_type == "POINT":
                    return (scale[0], scale[1], location[0], location[1])
                if scale[0] != 0 and scale[1] != 0:
                    return (1 / scale[0], 1 / scale[1], -location[0] / scale[0], -location[1] / scale[1])
        self._is_uv(None, None)
        self.warn(f"material '{self.name}': only UV coordinates, scaled and moved, place images; "
                  f"those of '{node.name}' are used as they are")
        return PLAIN_MAPPING

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
        amount = self._value(node.inputs["Fac"], True)
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

    def _principled(self, node):
        get = node.inputs
        base, roughness = self._value(get["Base Color"]), self._value(get["Roughness"], True)
        metallic, transmission = self._value(get["Metallic"], True), self._value(get["Transmission"], True)
        normal = self._normal_map(node)
        for name in ("Subsurface", "Sheen", "Clearcoat", "Anisotropic", "Specular Tint"):
            if get[name].is_linked or get[name].default_value > 0:
                self.warn(f"material '{self.name}': Principled's {name} is not supported and left out")
        self._emit(self._value(get["Emission"]), self._plain(get["Emission Strength"]))
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
                eta = eta_of_specular(self._plain(get["Specular"]))
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
