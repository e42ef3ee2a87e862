"""Principled, of Blender 3.4 and of 4.0 and later, as pbrt-v4 materials."""

import math

import bpy
import numpy as np

from .emission import either
from .export_shaders import squared, stretch_of_layers
from .export_subsurface import SubsurfaceExporter
from .values import Value


def eta_of_reflectance(reflectance):
    """The index of refraction of what reflects so much at the normal."""
    root = math.sqrt(min(max(reflectance, 0.0), 0.9))
    return (1 + root) / (1 - root)


def reflectance_of_eta(eta):
    """The share that a border of this index of refraction reflects at the normal."""
    return ((eta - 1) / (eta + 1)) ** 2


WHITE = Value((1.0, 1.0, 1.0))


def is_white(value):
    return not value.varies and min(value.constant) >= 1


# Features of Principled that are left out: names of the socket, and the value at which it changes
# nothing.
LEFT_OUT = ((("Sheen",), 0), (("Coat Normal", "Clearcoat Normal"), 0), (("Diffuse Roughness",), 0),
            (("Thin Wall",), 0), (("Transmission Dispersion Scale",), 0))


def is_colour(socket):
    """Whether the tint of specular is a colour, white without effect, as it is since Blender 4.0."""
    return hasattr(socket.default_value, "__len__")


class PrincipledExporter(SubsurfaceExporter):
    """Writes the materials that a node Principled stands for."""

    def _tell_left_out(self, inputs):
        """Warns of the features of Principled that are left out."""
        left_out = [(either(inputs, *names), without) for names, without in LEFT_OUT]
        if not is_colour(inputs["Specular Tint"]):
            left_out.append((inputs["Specular Tint"], 0))
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
        return 2 * reflectance_of_eta(max(self._plain(inputs["IOR"]), 1e-3)) * self._plain(inputs["Specular IOR Level"])

    def _sheen(self, inputs):
        """Parameters of the fibres over all else, which Principled has since Blender 4.0."""
        if "Sheen Weight" not in inputs or not (weight := self._plain(inputs["Sheen Weight"])) > 0:
            return []
        tint = self._value(inputs["Sheen Tint"])
        return [self._colour("sheen", tint.times(weight)),
                self._number("sheenroughness", self._value(inputs["Sheen Roughness"], True), squared, "squared")]

    def _coat(self, inputs, weight):
        """Parameters of the clear coat over all but the fibres; weight: a Value."""
        if not weight.varies and weight.constant <= 0:
            return []
        if "Clearcoat" in inputs:
            # Before Blender 4.0 a full coat reflects a quarter of what it reflects since.
            weight, eta, tint = weight.times(0.25), 1.5, []
        else:
            eta = max(self._plain(inputs["Coat IOR"]), 1.0001)
            tint = [self._colour("coattint", self._value(inputs["Coat Tint"]))]
        roughness = self._value(either(inputs, "Coat Roughness", "Clearcoat Roughness"), True)
        return [self._number("coat", weight), self._number("coatroughness", roughness, squared, "squared"),
                f'"float coateta" {eta:.9g}', *tint]

    def _specular_tint(self, inputs):
        """A Value of colour: the tint of what dielectrics reflect at the normal, and of metals' edges."""
        return self._value(inputs["Specular Tint"]) if is_colour(inputs["Specular Tint"]) else WHITE

    def _border(self, node, roughness, stretch):
        """Parameters of the specular border over what is diffuse."""
        reflectance, tint = self._reflectance(node.inputs), self._specular_tint(node.inputs)
        film = self._film(node.inputs)
        if is_white(tint):
            shape = film or self._scattering(node)
        else:
            shape = [self._colour("normalreflectance", tint, lambda t: t * reflectance, ("normal", reflectance)), *film]
        return [*self._roughness(roughness, stretch), f'"float eta" {max(eta_of_reflectance(reflectance), 1.0001):.9g}', *shape]

    def _under_specular(self, node, base, roughness, layers, stretch):
        """The diffuse surface under specular or, where light is scattered below it, the body. layers: parameters of those
        over all of it."""
        border, turned = self._border(node, roughness, stretch), self._normal_map(node)

        def diffuse():
            return self._make("coateddiffuse", [self._colour("reflectance", base), *border, '"bool reflectsthroughcoat" true',
                                                *turned, *layers])

        get = node.inputs
        weight = self._value(either(get, "Subsurface Weight", "Subsurface"), True)
        if not weight.varies and weight.constant <= 0:
            return diffuse()
        if layers:
            self.warn(f"material '{self.name}': Principled's coat and sheen are left out where light is scattered below the surface")
        scale = self._plain(get["Subsurface Scale"]) if "Subsurface Scale" in get else 1.0
        colour = base
        if "Subsurface Color" in get:
            # Before Blender 4.0 the weight mixes colours and scales the radius, and all light that enters is scattered below.
            share = min(self._plain(get["Subsurface"]), 1.0)
            scale *= share
            colour = self._mixed_colours(base, self._value(get["Subsurface Color"]), share)
            weight = Value(1.0)
        body = self._body(node, node.subsurface_method, colour, get["Subsurface Radius"], scale,
                          eta_of_reflectance(self._reflectance(get)), [*border, *turned])
        return body if not weight.varies and weight.constant >= 1 else self._mix(diffuse(), body, weight)

    def _mixed_colours(self, first, second, share):
        """Share `share` of the second Value of colour; of images one alone, the one of which there is more."""
        if first.varies or second.varies:
            if 0 < share < 1:
                self.warn(f"material '{self.name}': Principled's Base Color and Subsurface Color are not mixed where one is an image")
            return second if share >= 0.5 else first
        return Value(tuple(a + share * (b - a) for a, b in zip(first.constant, second.constant)))

    def _is_mixed_with_uncoated(self, inputs, weight):
        """Whether a part of the surface has no coat, as in Cycles from 5.3 on; before that all of it has one that is weaker. Without a tint
        both are the same."""
        return bpy.app.version >= (5, 3, 0) and (weight.varies or 0 < weight.constant < 1) and not is_white(self._value(inputs["Coat Tint"]))

    def _principled(self, node):
        self._tell_left_out(node.inputs)
        weight = self._value(either(node.inputs, "Coat Weight", "Clearcoat"), True)
        if not self._is_mixed_with_uncoated(node.inputs, weight):
            return self._coated(node, weight)
        return self._mix(self._coated(node, Value(0.0)), self._coated(node, Value(1.0)), weight)

    def _coated(self, node, coat_weight):
        """The material of a node whose coat has this weight, a Value."""
        get = node.inputs
        base, roughness = self._value(get["Base Color"]), self._value(get["Roughness"], True)
        metallic = self._value(get["Metallic"], True)
        transmission = self._value(either(get, "Transmission Weight", "Transmission"), True)
        layers = self._sheen(get) + self._coat(get, coat_weight)
        rest = self._normal_map(node) + layers
        stretch = self._stretch(node, "Anisotropic", "Anisotropic Rotation", stretch_of_layers)

        def is_constant(value, number):
            return not value.varies and value.constant == number

        def glass():
            if not is_white(self._specular_tint(get)):
                self.warn(f"material '{self.name}': Principled's Specular Tint is not supported on glass and left out")
            # Since Blender 4.0 the colour is that of two crossings.
            root = (lambda colour: np.sqrt(np.maximum(colour, 0)), "root") if "Transmission Weight" in get else ()
            return self._clear(base, roughness, self._plain(get["IOR"]), self._film(get) + self._scattering(node) + rest, *root,
                               stretch=stretch)

        parts = []
        if not is_constant(metallic, 1):
            if is_constant(transmission, 1):
                parts.append(glass())
            else:
                coated = self._under_specular(node, base, roughness, layers, stretch)
                if not is_constant(transmission, 0):
                    coated = self._mix(coated, glass(), transmission)
                parts.append(coated)
        if not is_constant(metallic, 0):
            # Before Blender 5.0 the film is on what is no metal alone.
            film = self._film(get) if bpy.app.version >= (5, 0, 0) else []
            parts.append(self._metal(base, roughness, self._specular_tint(get), film + self._scattering(node) + rest, stretch))
        return parts[0] if len(parts) == 1 else self._mix(parts[0], parts[1], metallic)
