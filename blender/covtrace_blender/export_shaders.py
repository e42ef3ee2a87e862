"""Textures and plain materials as text of pbrt-v4, from Values."""

import math

import numpy as np

from .angles import MOST_CONSTANTS, MOST_IMAGES
from .export_sockets import SocketReader
from .shader_nodes.unsupported import NeedsBody, Unsupported
from .tangents import Tangent
from .values import Between, ByAngle


def numbers(values):
    return " ".join(f"{v:.9g}" for v in values)


def squared(roughness):
    """The width alpha of GGX."""
    return np.maximum(roughness, 0) ** 2


def stretch_of_glossy(anisotropy):
    """Factors on alpha along and across the tangent, of the nodes Glossy and Glass."""
    across = 1 - min(abs(anisotropy), 0.99)
    return (across, 1 / across) if anisotropy > 0 else (1 / across, across)


def stretch_of_layers(anisotropy):
    """The same of the nodes Principled and Metallic, which have no anisotropy below 0."""
    aspect = math.sqrt(1 - 0.9 * min(max(anisotropy, 0), 1))
    return 1 / aspect, aspect


class ShaderWriter(SocketReader):
    """Writes textures and materials into `out`, counted by `count`, and their images to `files`. tangent: the Tangent that
    anisotropic shaders want, or None. heights: (FlatSocket of heights, factor on them) for shaders to which nothing gives normals, or None."""

    tangent, heights = None, None

    def _texture(self, kind, value, treat=lambda v: v, key="", most=1.0, shines=False):
        """Declares a texture of a Value and returns its name. treat: what makes of its values, which are clipped to [0, most], those of the
        texture; key: tells that from others, "" being none. shines: whether images may be brighter than 1."""
        rest = treat, key, most, shines
        if isinstance(value, ByAngle):
            if key and not value.parts[0].varies:
                value = value.resampled(MOST_CONSTANTS)  # treated values are not linear where these are
            return self._facing(kind, value.cosines, [self._texture(kind, part, *rest) for part in value.parts])
        if isinstance(value, Between) and key:
            few = value.share.resampled(MOST_IMAGES)
            return self._facing(kind, few.cosines, [self._texture_between(kind, value, part.constant, treat, key) for part in few.parts])
        if isinstance(value, Between):
            first, second = (self._texture(kind, part, *rest) for part in (value.first, value.second))
            share = self._texture("float", value.share)
            return self._named_texture(kind, "mix", f'"texture tex1" "{first}" "texture tex2" "{second}" "texture amount" "{share}"')
        if not value.varies:
            constant = treat(np.clip(np.array(value.constant, dtype=float), 0, most))
            return self._named_texture(kind, "constant", f'"{"float" if kind == "float" else "rgb"} value" [{numbers(np.ravel(constant))}]')
        if shines:
            return self._declare(kind, value, self.files.write_emission(value.image, value.key(), value.apply), encoding="sRGB")
        return self._declare(kind, value, self.files.write(value.image, (value.key(), kind, key), lambda pixels: treat(value.apply(pixels))))

    def _texture_between(self, kind, value, share, treat, key):
        """Declares the texture of a Between where this is the share of its second image."""
        def mixed(pixels):
            second = value.second.apply(self.files.source(value.second.image))
            return treat((1 - share) * value.first.apply(pixels) + share * second)

        return self._declare(kind, value.first, self.files.write(value.first.image, (value.key(), kind, key, share), mixed))

    def _facing(self, kind, cosines, names):
        """Declares the texture that has these textures at cosines of the angle of sight."""
        quoted = " ".join(f'"{name}"' for name in names)
        return self._named_texture(kind, "facing", f'"string textures" [{quoted}] "float cosines" [{numbers(cosines)}]')

    def _named_texture(self, kind, model, parameters):
        name = f"texture {self.count}"
        self.count += 1
        self.out.write(f'Texture "{name}" "{kind}" "{model}" {parameters}\n')
        return name

    def _declare(self, kind, value, file, scale=1.0, encoding="linear"):
        """Declares the texture of an image that lies in a file, `scale` times."""
        su, sv, du, dv = value.mapping
        return self._named_texture(kind, "imagemap", (
            f'"string filename" "{file}" "string encoding" "{encoding}" "float uscale" {su:.9g} "float vscale" {sv:.9g} '
            f'"float udelta" {du:.9g} "float vdelta" {dv:.9g} "string filter" "{value.filter}" '
            f'"string wrap" "{value.wrap}" "float scale" {scale:.9g}'))

    def _colour(self, parameter, value, treat=lambda v: v, key=""):
        if value.varies:
            return f'"texture {parameter}" "{self._texture("spectrum", value, treat, key)}"'
        rgb = treat(np.clip(np.array(value.constant, dtype=float), 0, 1))
        return f'"rgb {parameter}" [{numbers(rgb)}]'

    def _index(self, parameter, value):
        """Numbers of any size per channel, as textures, which are taken as they are; colours would become spectra."""
        return f'"texture {parameter}" "{self._texture("spectrum", value, most=np.inf)}"'

    def _number(self, parameter, value, treat=lambda v: v, key=""):
        if value.varies:
            return f'"texture {parameter}" "{self._texture("float", value, treat, key, np.inf)}"'
        return f'"float {parameter}" {float(treat(np.array(value.constant))):.9g}'

    def _film(self, inputs):
        """Parameters of a film in which light interferes, which Principled has since Blender 4.2; none where there is no film."""
        thickness = inputs.get("Thin Film Thickness")
        if thickness is None or not (thickness.is_linked or thickness.default_value > 0):
            return []
        return [self._number("filmthickness", self._value(thickness, True)),
                f'"float filmeta" {max(self._plain(inputs["Thin Film IOR"]), 1):.9g}']

    def _make(self, kind, parameters):
        name = f"material {self.count}"
        self.count += 1
        self.out.write(f'MakeNamedMaterial "{name}" "string type" "{kind}" {" ".join(parameters)}\n')
        return name

    def _mix(self, first, second, amount):
        """Share `amount` of the second one."""
        if not amount.varies:
            share = min(max(float(amount.constant), 0.0), 1.0)
            if share == 0:
                return first
            if share == 1:
                return second
        return self._make("mix", [f'"string materials" ["{first}" "{second}"]', self._number("amount", amount)])

    def _roughness(self, value, stretch=None):
        """Blender's roughness squared is the width alpha of GGX. stretch: factors on that along and across the tangent."""
        if stretch is None:
            return [self._number("roughness", value, squared, "squared"), '"bool remaproughness" false']
        return [*(self._number(f"{axis}roughness", value, lambda r, by=by: np.minimum(squared(r) * by, 1), ("squared", by))
                  for axis, by in zip("uv", stretch)), '"bool remaproughness" false']

    def _stretch(self, node, amount, turn, stretch_of):
        """The factors on alpha of an anisotropic node, by its sockets, whose tangent is kept; None where it is none."""
        if amount not in node.inputs or not (node.inputs[amount].is_linked or node.inputs[amount].default_value != 0):
            return None
        strength = self._plain(node.inputs[amount])
        if strength == 0:
            return None
        self._keep_tangent(node, 2 * math.pi * self._plain(node.inputs[turn]))
        return stretch_of(strength)

    def _keep_tangent(self, node, turn):
        """Notes the tangents that a node wants of its mesh, which has those of one node."""
        source, _ = self._linked(node.inputs["Tangent"])
        if source is None:
            found = Tangent("Z", "", turn)
        elif source.type == "TANGENT":
            found = Tangent(source.axis if source.direction_type == "RADIAL" else "", source.uv_map, turn)
        else:
            self.warn(f"material '{self.name}': only the node Tangent gives tangents; those of '{node.name}' go around the z axis")
            found = Tangent("Z", "", turn)
        if self.tangent is not None and not self.tangent.is_same(found):
            self.warn(f"material '{self.name}': its anisotropic shaders have several tangents; one is used for all")
        elif node.inputs["Normal"].is_linked:
            self.warn(f"material '{self.name}': the anisotropy of '{node.name}' goes along the UV map, as its normals are changed")
        else:
            self.tangent = found

    def _normal_map(self, node):
        """Parameters of the map that turns the normal; maps lie as the texture coordinates do, as in Cycles."""
        source, _ = self._linked(node.inputs["Normal"])
        found = self._map_of(source) if source else self._displaced([self.heights]) if self.heights else []
        return [*found, '"bool mapsfollowuv" true'] if found else []

    def _map_of(self, source):
        if source.type == "BUMP":
            return self._bump(source)
        if source.type == "NORMAL_MAP" and source.space == "TANGENT":
            value = self._value(source.inputs["Color"], only_unit_square=True, by_angle=False)
            strength = self._plain(source.inputs["Strength"])
            # Maps by the convention of DirectX, which Blender knows since 5.1, have y downwards.
            strengths = (strength, -strength if getattr(source, "convention", "") == "DIRECTX" else strength, strength)
            if source.uv_map and source.uv_map not in self.uv_maps:
                self.uv_maps.append(source.uv_map)
            if value.varies and not self.surface.body and not value.is_plainly_placed():
                self._ask_for_body(NeedsBody(source, "a normal map lies on the unit square alone"))
            if value.varies and self.surface.body:
                return self._normals_on_body(value.image, ("UV", source.uv_map), strengths)
            if value.varies:
                def scaled(colour):
                    # Cycles blends from the flat normal.
                    flat = np.array([0.5, 0.5, 1.0], dtype=np.float32)
                    return flat + (colour - flat) * np.array(strengths, np.float32)
                file = self.files.write(value.image, ("normal", strengths), lambda p: scaled(value.apply(p)))
                if not value.is_plainly_placed():
                    self.warn(f"material '{self.name}': a normal map is used as it lies, unscaled and interpolated")
                return [f'"string normalmap" "{file}"']
        self.warn(f"material '{self.name}': only bumps and tangent space normal maps change normals")
        return []

    def _normals_on_body(self, image, uv_map, strengths):
        """A normal map in the frame of the atlas, of one in the frame of a UV map."""
        body = self.surface.body
        if not body.knows(uv_map):
            self.warn(f"material '{self.name}': a normal map without a UV map is left out")
            return []
        found = self.baked.turned(image, body, uv_map, strengths)
        return [f'"string normalmap" "{self.files.write(found, "normals", lambda pixels: pixels[..., :3])}"']

    def _bump(self, node):
        """A texture of heights in the scene's unit; those of Bumps that give each other their normals are added up, as their slopes nearly are
        in Cycles."""
        parts, strengths, base = [], [], node
        while base is not None and base.type == "BUMP":
            parts.append((base.inputs["Height"], self._plain(base.inputs["Distance"]) * (-1 if base.invert else 1)))
            strengths.append(max(self._plain(base.inputs["Strength"]), 0))
            last, (base, _) = base, self._linked(base.inputs["Normal"])
        if base is not None:
            self.warn(f"material '{self.name}': the Normal of '{last.name}' is not supported and left out")
        strength = max(strengths)
        if strength == 0:
            return []
        found = self._displaced([(height, scale * own / strength) for (height, scale), own in zip(parts, strengths)], node.outputs[0])
        return [*found, f'"float bumpstrength" {strength:.9g}'] if found and strength != 1 else found

    def _displaced(self, parts, output=None):
        """The texture of the sum of [(socket of heights, factor)]; output: of the node that adds several."""
        scale = parts[0][1] if len(parts) == 1 else 1.0
        try:
            if len(parts) == 1:
                height = self._baked_value(parts[0][0], is_number=True, by_angle=False)
            else:
                height = self._baked_function(lambda nodes: sum(factor * nodes.number(socket) for socket, factor in parts), output,
                                              ("heights", *(factor for _, factor in parts)), by_angle=False)
        except Unsupported as problem:
            self._ask_for_body(problem)
            self.warn(f"material '{self.name}': node '{problem.node.name}' at 'Height' is not supported ({problem.reason}); "
                      "the surface is flat there")
            return []
        if not height.varies:
            return []
        name = self._declare("float", height, self.files.write_heights(height.image), scale)
        return [f'"texture displacement" "{name}"']

    def _scattering(self, node, prefix=""):
        """Parameters of metal and glass whose facets pass light on to each other, where a node's distribution says so."""
        return [f'"bool {prefix}multiplescattering" true'] if node.distribution == "MULTI_GGX" else []

    def _metal(self, colour, roughness, edge, rest, stretch=None):
        """edge: the Value of the tint at 82 degrees, whose reflectance else goes to 1 at grazing angles by Schlick's formula;
        None: it is the same at all angles."""
        shape = ['"string edge" "none"'] if edge is None else ['"string edge" "schlick"', self._colour("edgetint", edge)]
        return self._make("conductor", [self._colour("reflectance", colour), *shape, *self._roughness(roughness, stretch), *rest])

    def _clear(self, colour, roughness, eta, rest, *treat, stretch=None):
        """treat: what makes of the colour the share that one crossing lets pass, as of _colour."""
        return self._make("dielectric", [f'"float eta" {max(eta, 1.0001):.9g}',
                                         self._colour("transmittance", colour, *treat), *self._roughness(roughness, stretch), *rest])
