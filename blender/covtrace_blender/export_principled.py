"""Principled, of Blender 3.4 and of 4.0 and later, as pbrt-v4 materials."""

import math

import numpy as np

from .emission import EmissionReader, either
from .export_shaders import squared
from .export_sockets import Value


def eta_of_reflectance(reflectance):
    """The index of refraction of what reflects so much at the normal."""
    root = math.sqrt(min(max(reflectance, 0.0), 0.9))
    return (1 + root) / (1 - root)


def reflectance_of_eta(eta):
    """The share that a border of this index of refraction reflects at the normal."""
    return ((eta - 1) / (eta + 1)) ** 2


def covered_reflectance(reflectance, eta):
    """The reflectance of a metal in air that reflects `reflectance` under a coat of index `eta`.

    pbrt-v4 describes metals by a reflectance in air, of index 1 and as absorbing as that needs, and has both divided by
    the coat's index.
    """
    reflectance = np.clip(np.asarray(reflectance, float), 0, 0.9999)
    below, above = (1 / eta - 1) ** 2, (1 / eta + 1) ** 2
    square = np.maximum(reflectance * above - below, 0) / (1 - reflectance) * eta**2
    return square / (4 + square)


# Features of Principled that are left out: names of the socket, and the value at which it changes
# nothing.
LEFT_OUT = ((("Subsurface Weight", "Subsurface"), 0), (("Sheen",), 0), (("Anisotropic",), 0),
            (("Coat Normal", "Clearcoat Normal"), 0), (("Diffuse Roughness",), 0), (("Thin Film Thickness",), 0))


class PrincipledExporter(EmissionReader):
    """Writes the materials that a node Principled stands for."""

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
        return 2 * reflectance_of_eta(max(self._plain(inputs["IOR"]), 1e-3)) * self._plain(inputs["Specular IOR Level"])

    def _sheen(self, inputs):
        """Parameters of the fibres over all else, which Principled has since Blender 4.0."""
        if "Sheen Weight" not in inputs or not (weight := self._plain(inputs["Sheen Weight"])) > 0:
            return []
        tint = self._value(inputs["Sheen Tint"])
        colour = tint.times(weight) if tint.image else Value(tuple(weight * c for c in tint.constant))
        return [self._colour("sheen", colour),
                self._number("sheenroughness", self._value(inputs["Sheen Roughness"], True), squared, "squared")]

    def _coat(self, inputs):
        """(weight, roughness, index of refraction) of the coat as Values, the last as a number; weight 0: there is none."""
        weight = self._value(either(inputs, "Coat Weight", "Clearcoat"), True)
        if "Clearcoat" in inputs:
            # Before Blender 4.0 a full coat reflects a quarter of what it reflects since.
            return weight.times(0.25), self._value(inputs["Clearcoat Roughness"], True), 1.5
        eta = max(self._plain(inputs["Coat IOR"]), 1.0001)
        return weight, self._value(inputs["Coat Roughness"], True), eta

    def _seen_through_coat(self, inputs):
        """The share of light that gets through a full coat with a tint, down and back, per channel: the tint is that of light
        along the normal, and other light has a longer way through the coat."""
        if "Coat Tint" not in inputs:
            return np.ones(3)
        tint = self._value(inputs["Coat Tint"])
        if tint.image:
            self.warn(f"material '{self.name}': an image as the coat's tint is not supported and left out")
            return np.ones(3)
        eta = self._coat(inputs)[2]
        # The mean, over light from all around, of the way by that along the normal
        way = np.mean(1 / np.sqrt(1 - (1 - (np.arange(64) + 0.5) / 64) / eta**2))
        return np.clip(tint.constant, 0, 1) ** way

    def _under_coat(self, inputs, base, roughness, normal):
        """Diffuse under specular under the coat. Two borders are one that reflects as much as both, and that is at each
        hit as rough as the one or the other, in the proportion of what they reflect."""
        specular = self._reflectance(inputs)
        weight, coat_roughness, coat_eta = self._coat(inputs)
        if weight.image:
            self.warn(f"material '{self.name}': a coat over no metal that an image weighs is not supported and left out")
            weight = Value(0.0)
        share = min(max(weight.constant, 0), 1)
        coat = share * reflectance_of_eta(coat_eta)
        eta = eta_of_reflectance(specular + coat)
        tinted = ()
        if share > 0:
            through = 1 - share + share * self._seen_through_coat(inputs)
            tinted = (lambda r: r * through, ("through", *through))

        def layers(rough):
            return self._make("coateddiffuse", [
                self._colour("reflectance", base, *tinted), *self._roughness(rough),
                f'"float eta" {max(eta, 1.0001):.9g}',
                '"bool reflectsthroughcoat" true', *normal])

        if coat == 0:
            return layers(roughness)
        return self._mix(layers(roughness), layers(coat_roughness), Value(coat / (coat + specular)))

    def _metal_under_coat(self, node, base, roughness, normal):
        inputs = node.inputs
        metal = self._metal(base, roughness, self._scattering(node) + normal)
        weight, coat_roughness, eta = self._coat(inputs)
        if not weight.image and weight.constant <= 0:
            return metal
        through = self._seen_through_coat(inputs)
        coated = self._make("coatedconductor", [
            self._colour("reflectance", base, lambda r: covered_reflectance(r * through, eta), ("under", eta, *through)),
            self._number("conductor.roughness", roughness, squared, "squared"),
            self._number("interface.roughness", coat_roughness, squared, "squared"), f'"float interface.eta" {eta:.9g}',
            '"float thickness" 0', '"bool remaproughness" false', *self._scattering(node, "conductor."), *normal])
        return self._mix(metal, coated, weight)

    def _principled(self, node):
        get = node.inputs
        base, roughness = self._value(get["Base Color"]), self._value(get["Roughness"], True)
        metallic = self._value(get["Metallic"], True)
        transmission = self._value(either(get, "Transmission Weight", "Transmission"), True)
        normal = self._normal_map(node) + self._sheen(get)
        self._tell_left_out(get)

        def is_constant(value, number):
            return not value.image and value.constant == number

        def glass():
            return self._clear(base, roughness, self._plain(get["IOR"]), self._scattering(node) + normal)

        parts = []
        if not is_constant(metallic, 1):
            if is_constant(transmission, 1):
                if not is_constant(self._coat(get)[0], 0):
                    self.warn(f"material '{self.name}': a coat over glass is not supported and left out")
                parts.append(glass())
            else:
                coated = self._under_coat(get, base, roughness, normal)
                if not is_constant(transmission, 0):
                    coated = self._mix(coated, glass(), transmission)
                parts.append(coated)
        if not is_constant(metallic, 0):
            parts.append(self._metal_under_coat(node, base, roughness, normal))
        return parts[0] if len(parts) == 1 else self._mix(parts[0], parts[1], metallic)
