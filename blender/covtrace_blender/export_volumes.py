"""Volumes of materials as even media, and which of them a place is in."""

import functools
import math

import numpy as np

from .export_shaders import numbers
from .shader_nodes.blackbody import blackbody
from .shader_nodes.flat import flat_output
from .shader_nodes.light_path import RAYS
from .shader_nodes.unsupported import Unsupported
from .solid import Solid


# Absorption per unit of length of what shines: pbrt's media shine by as much as they absorb. A hundred units dim by a thousandth.
LEAST_ABSORPTION = 1e-5

STEFAN_BOLTZMANN = 5.670373e-14 / math.pi  # of Cycles' blackbodies in volumes, by the fourth power of the temperature


class Coefficients:
    """Scattering and absorption of an even medium per unit of length, and the radiance that it adds on that, each in R, G, B; g: the mean
    cosine of scattering."""

    def __init__(self, scattering=(0, 0, 0), absorption=(0, 0, 0), g=0.0, light=(0, 0, 0)):
        self.scattering, self.absorption, self.g, self.light = tuple(scattering), tuple(absorption), g, tuple(light)

    def plus(self, other):
        """The sum, with the mean of both cosines by how much each scatters."""
        weights = sum(self.scattering), sum(other.scattering)
        g = (self.g * weights[0] + other.g * weights[1]) / sum(weights) if sum(weights) > 0 else 0.0
        return Coefficients(_sum(self.scattering, other.scattering), _sum(self.absorption, other.absorption), g, _sum(self.light, other.light))

    def text(self):
        """Parameters of pbrt's homogeneous medium."""
        shines = max(self.light) > 0
        absorption = [max(a, LEAST_ABSORPTION) for a in self.absorption] if shines else self.absorption
        light = f' "rgb Le" [{numbers(c / a for c, a in zip(self.light, absorption))}]' if shines else ""
        return f'"rgb sigma_s" [{numbers(self.scattering)}] "rgb sigma_a" [{numbers(absorption)}] "float g" {self.g:.9g}{light}'


def _sum(first, second):
    return [a + b for a, b in zip(first, second)]


def _light_of_principled(node, colour_of, number_of):
    """The radiance that a node Principled Volume adds per unit of length; its density does not count."""
    strength, glow = (max(number_of(node.inputs[name]), 0) for name in ("Emission Strength", "Blackbody Intensity"))
    light = [strength * max(c, 0) for c in colour_of(node.inputs["Emission Color"])] if strength > 0 else (0, 0, 0)
    if glow > 0:
        temperature = max(number_of(node.inputs["Temperature"]), 0)
        power = STEFAN_BOLTZMANN * (1 + glow * (temperature**4 - 1))
        light = _sum(light, [power * max(c * t, 0) for c, t in zip(blackbody(temperature), colour_of(node.inputs["Blackbody Tint"]))])
    return light


def coefficients(node, colour_of, number_of, tell):
    """The Coefficients of a volume shader's node, as Cycles has them.

    colour_of(socket), number_of(socket): what a socket has everywhere. tell(text): what is left out. Raises Unsupported.
    """
    def shader(socket):
        if not socket.is_linked:
            return Coefficients()
        return coefficients(socket.links[0].from_node, colour_of, number_of, tell)

    if node.type == "ADD_SHADER":
        return shader(node.inputs[0]).plus(shader(node.inputs[1]))
    if node.type == "EMISSION":
        strength = max(number_of(node.inputs["Strength"]), 0)
        return Coefficients(light=[max(c, 0) * strength for c in colour_of(node.inputs["Color"])])
    if node.type not in ("VOLUME_SCATTER", "VOLUME_ABSORPTION", "PRINCIPLED_VOLUME"):
        raise Unsupported(node, "it is no even medium")
    density = max(number_of(node.inputs["Density"]), 0)
    colour = [max(c, 0) for c in colour_of(node.inputs["Color"])]
    if node.type == "VOLUME_ABSORPTION":
        return Coefficients(absorption=[max(1 - c, 0) * density for c in colour])
    scattering, absorption, light = [c * density for c in colour], (0, 0, 0), (0, 0, 0)
    g = number_of(node.inputs["Anisotropy"])
    if node.type == "PRINCIPLED_VOLUME":
        kept = [max(c, 0) ** 0.5 for c in colour_of(node.inputs["Absorption Color"])]
        absorption = [max(1 - c, 0) * max(1 - k, 0) * density for c, k in zip(colour, kept)]
        light = _light_of_principled(node, colour_of, number_of)
    elif getattr(node, "phase", "HENYEY_GREENSTEIN") != "HENYEY_GREENSTEIN":
        tell(f"the phase function of '{node.name}' is not supported; Henyey-Greenstein takes its place")
    return Coefficients(scattering, absorption, min(max(g, -0.99), 0.99), light)


def has_volume(material):
    """Whether a material has a volume, supported or not."""
    output = flat_output(material.node_tree) if material and material.use_nodes and material.node_tree else None
    return output is not None and output.inputs["Volume"].is_linked


class Media:
    """Writes even media into `out`, each once."""

    def __init__(self, out):
        self.out, self._coefficients, self._sums = out, {}, {}

    def add(self, found):
        """The name of a medium of these Coefficients."""
        name = f"medium {len(self._coefficients)}"
        self._coefficients[name] = found
        self.out.write(f'MakeNamedMedium "{name}" "string type" "homogeneous" {found.text()}\n')
        return name

    def sum(self, names):
        """The name of the medium where all these are at once, in any order, as in Cycles; "" of none."""
        names = tuple(sorted(names))
        if len(names) < 2:
            return "".join(names)
        if names not in self._sums:
            self._sums[names] = self.add(functools.reduce(Coefficients.plus, (self._coefficients[name] for name in names)))
        return self._sums[names]


class Volumes:
    """Instances whose materials have media. `add` them all before asking where a place is."""

    def __init__(self):
        self._solids, self._bodies, self._inverses = {}, [], []

    def add(self, obj, matrix, medium, rays):
        """rays: the kinds that see it."""
        if abs(matrix.determinant()) < 1e-30 or not obj.data.polygons:
            return
        mesh = obj.data.as_pointer()
        if mesh not in self._solids:
            self._solids[mesh] = Solid(obj.data)
        self._bodies.append((obj.name_full, self._solids[mesh], medium, set(rays)))
        self._inverses.append(np.array(matrix.inverted()))

    @functools.cached_property
    def _boxes(self):
        """(inverse matrix, low and high corner in its own space) of each body."""
        solids = [solid for _, solid, _, _ in self._bodies]
        return np.array(self._inverses), np.array([s.low for s in solids]), np.array([s.high for s in solids])

    def media_at(self, place, but="", rays=RAYS):
        """The names of the media of all that hold a place of the world and that one of these kinds of rays sees; `but`: the
        name of an object that does not count."""
        if not self._bodies:
            return ()
        inverses, low, high = self._boxes
        # Few boxes hold the place; only these are worth rays.
        places = inverses[:, :3, :3] @ np.array(place) + inverses[:, :3, 3]
        found = []
        for index in np.flatnonzero(((low <= places) & (places <= high)).all(1)):
            name, solid, medium, seen_by = self._bodies[index]
            if name != but and seen_by.intersection(rays) and solid.holds(places[index]):
                found.append(medium)
        return tuple(found)
