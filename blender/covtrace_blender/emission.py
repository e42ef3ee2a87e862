"""The light that a tree of shaders sends out: that of each of its shaders by the share that mixtures leave it."""

import numpy as np

from .export_shaders import numbers
from .opacity import OpacityReader
from .shader_nodes.unsupported import Unsupported
from .values import Value


class Emission:
    """The light of an area light: its radiance, or that of white in an image, by the image's file, or in a texture, by its name."""

    def __init__(self, radiance, file=None, texture=None):
        self.radiance, self.file, self.texture = radiance, file, texture

    def parameters(self):
        """pbrt's."""
        if self.file:
            return f'"string filename" "{self.file}" "float scale" {self.radiance[0]:.9g}'
        texture = f' "texture radiance" "{self.texture}"' if self.texture else ""
        return f'"rgb L" [{numbers(self.radiance)}]{texture}'


class Light:
    """The light of one shader: the sockets of its colour and strength, and its weight. share: a number, or None where images
    make it; steps: [(Mix, whether it is the second part of it)] on the way there; opacity: the socket of what weakens it
    besides, or None."""

    def __init__(self, colour, strength, share, steps, opacity=None):
        self.colour, self.strength, self.share, self.steps, self.opacity = colour, strength, share, steps, opacity


def either(inputs, *names):
    """The socket by the first of its names that this Blender has: version 4.0 renamed some."""
    return next((inputs[name] for name in names if name in inputs), None)


class EmissionReader(OpacityReader):
    """Reads the emission of shaders. It counts where they stop light, so that mixtures with what lets it pass don't weaken it;
    in trees that are `in_full` it counts everywhere, and such mixtures weaken it."""

    in_full = False

    def _emission_of(self, node):
        """The Emission of a tree, or None."""
        lights = self._lights(node, 1.0, ())
        if not lights:
            return None
        colours = [self._value(light.colour, only_unit_square=True) for light in lights]
        strengths = [self._value(light.strength, True) for light in lights]
        parts = list(zip(lights, colours, strengths))
        if all(light.share is not None for light in lights):
            if not any(value.varies for value in (*colours, *strengths)):
                return self._shining(Value(tuple(sum(c.constant[k] * s.constant * light.share for light, c, s in parts) for k in range(3))))
            if len(lights) == 1 and not strengths[0].varies:
                return self._shining(colours[0], strengths[0].constant * lights[0].share)
        try:
            return self._shining(self._baked_function(lambda nodes: self._light_at(nodes, parts), node.outputs[0], ("emission",), True))
        except Unsupported as problem:
            self._ask_for_body(problem)
            self.warn(f"material '{self.name}': node '{problem.node.name}' is not supported ({problem.reason}); of its emission the first part "
                      "alone is there, and not weakened")
            return self._shining(colours[0], self._plain(lights[0].strength))

    def _shines(self, node):
        """Whether there may be light in a tree: that of Principled is off in most materials."""
        if node is None:
            return False
        if node.type in ("MIX_SHADER", "ADD_SHADER"):
            return any(self._shines(self._linked(socket)[0]) for socket in node.inputs[-2:])
        colour, strength = self._light_sockets(node)
        return colour is not None and (strength.is_linked or strength.default_value != 0) and \
            (colour.is_linked or max(tuple(colour.default_value)[:3]) > 0)

    @staticmethod
    def _light_sockets(node):
        """The colour and the strength of what a shader sends out; None of those that send out nothing."""
        if node.type == "EMISSION":
            return node.inputs["Color"], node.inputs["Strength"]
        if node.type == "BSDF_PRINCIPLED":
            return either(node.inputs, "Emission Color", "Emission"), node.inputs["Emission Strength"]
        return None, None

    def _lights(self, node, share, steps):
        """The Lights of a tree, whose own weight is `share`."""
        if not self._shines(node):
            return []
        if node.type == "ADD_SHADER":
            return [light for socket in node.inputs[-2:] for light in self._lights(self._linked(socket)[0], share, steps)]
        if node.type != "MIX_SHADER":
            return [self._light(node, share, steps)]
        parts = self._parts(node)
        opacities = [Value(1.0) if self.in_full else self._opacity(part) for part in parts]
        second = self._share_of_opaque(node, self._mix_share(node), *opacities)
        found = []
        for part, opacity, is_second in zip(parts, opacities, (False, True)):
            if not opacity.varies and opacity.constant <= 0:
                continue
            own = None if second.varies else second.constant if is_second else 1 - second.constant
            if own != 0:
                found += self._lights(part, None if own is None or share is None else own * share, (*steps, (node, is_second)))
        return found

    def _light(self, node, share, steps):
        """The Light of a shader's node."""
        sockets, opacity = self._light_sockets(node), self._opacity(node) if self.in_full else Value(1.0)
        if opacity.varies:
            return Light(*sockets, None, steps, node.inputs["Alpha"])
        return Light(*sockets, None if share is None else share * opacity.constant, steps)

    def _light_at(self, nodes, lights):
        """The sum of [(Light, colour, strength)] at the places of an Evaluator: (3,) or (n, 3)."""
        total = np.zeros(3, np.float32)
        for light, colour, strength in lights:
            weight = nodes.number(light.strength) if strength.varies else strength.constant
            for mix, is_second in light.steps:
                share = self._share_at(nodes, mix) if self.in_full else self._opaque_share_at(nodes, mix)
                weight = weight * (share if is_second else 1 - share)
            if light.opacity:
                weight = weight * np.clip(nodes.number(light.opacity), 0, 1)
            total = total + np.asarray(weight)[..., None] * (nodes.vector(light.colour) if colour.varies else np.array(colour.constant))
        return total.astype(np.float32)

    def _shining(self, colour, strength=1.0):
        """The Emission of a colour's Value `strength` times; None where nothing shines."""
        if not colour.varies:
            radiance = tuple(c * strength for c in colour.constant)
            return Emission(radiance) if max(radiance) > 0 else None
        if not colour.is_plainly_placed():
            self.warn(f"material '{self.name}': an image that shines is used as it lies, unscaled and interpolated")
        if colour.image:
            return Emission((strength,) * 3, self.files.write_emission(colour.image, colour.key(), colour.apply))
        return Emission((strength,) * 3, texture=self._texture("spectrum", colour, most=np.inf, shines=True))
