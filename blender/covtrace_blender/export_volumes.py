"""Volume shaders as media."""

import math

import bpy
import numpy as np

from .coefficients import Coefficients
from .media import VaryingMedium
from .node_signature import tree_of
from .shader_nodes.blackbody import blackbodies
from .shader_nodes.evaluator import Evaluator
from .shader_nodes.flat import flat_output
from .shader_nodes.place import VolumePlace
from .shader_nodes.unsupported import Unsupported
from .volume_lattice import PROBES, lattice_for, most_of_each

STEFAN_BOLTZMANN = 5.670373e-14 / math.pi  # of Cycles' blackbodies in volumes, by the fourth power of the temperature

# Since Blender 5 Cycles looks up one of the voxels around a place by chance: nodes make the same of each, and means are linear between them.
AT_VOXELS = bpy.app.version >= (5, 0, 0)
WITH_BOXES = (5, 3, 0)  # in which what hangs on no grid fills the box around the grids, and not in 5.0, where it is up to a fifth brighter
UNEVEN = 0.05  # of a colour's channel: what is less is hardly seen
COARSE = 0.12  # of the mean: three times the error that a lattice is to have


class _Sockets:
    """Values of volume shaders' sockets at the places of an Evaluator; what is left out is told."""

    def __init__(self, nodes, tell):
        self._nodes, self.tell = nodes, tell

    def number(self, socket):
        return self._value(socket, self._nodes.number)

    def colour(self, socket):
        return np.maximum(self._value(socket, self._nodes.vector), 0)

    def _value(self, socket, get):
        try:
            return np.asarray(get(socket), np.float32)
        except Unsupported as problem:
            self.tell(f"node '{problem.node.name}' at '{socket.name}' of a volume is not supported ({problem.reason}); the socket's own value "
                      "is used")
            value = np.asarray(socket.default_value, np.float32)
            return value[:3] if value.ndim else value

    def grid(self, node, name):
        """(n, 3) of the attribute that a socket names; None where there is none."""
        socket = node.inputs.get(name)
        return self.grid_of(socket.default_value) if socket else None

    def grid_of(self, name):
        """(n, 3) of the attribute of this name; None where there is none."""
        return self._nodes.place.grid(name)


def _times(colour, number):
    return colour.astype(float) * number[..., None]  # which may be as large as there are numbers of single precision


def _light_of_principled(node, sockets):
    """The radiance that a node Principled Volume adds per unit of length; its density does not count."""
    strength, glow = (np.maximum(sockets.number(node.inputs[name]), 0) for name in ("Emission Strength", "Blackbody Intensity"))
    light = _times(sockets.colour(node.inputs["Emission Color"]), strength)
    if (glow > 0).any():
        temperature = np.maximum(sockets.number(node.inputs["Temperature"]), 0).astype(float)
        heat = sockets.grid(node, "Temperature Attribute")
        temperature = temperature if heat is None else temperature * np.maximum(heat.mean(-1), 0)
        power = STEFAN_BOLTZMANN * (1 + glow * (temperature**4 - 1))
        shine = _times(blackbodies(temperature) * sockets.colour(node.inputs["Blackbody Tint"]), np.maximum(power, 0))
        light = light + np.where((glow > 0)[..., None], shine, 0)
    return light


def coefficients(node, sockets):
    """The Coefficients of a volume shader's node, None for what has no material, as Cycles has them, by _Sockets. Raises Unsupported."""
    def shader(socket):
        return coefficients(socket.links[0].from_node, sockets) if socket.is_linked else Coefficients()

    if node is None:
        # Cycles' own for what has no material
        density = np.maximum(sockets.grid_of("density").mean(-1), 0)[:, None]
        return Coefficients(0.5 * density * np.ones(3), 0.5 * density * np.ones(3))
    if node.type == "ADD_SHADER":
        return shader(node.inputs[0]).plus(shader(node.inputs[1]))
    if node.type == "MIX_SHADER":
        share = np.clip(sockets.number(node.inputs[0]), 0, 1)
        return shader(node.inputs[1]).times(1 - share).plus(shader(node.inputs[2]).times(share))
    if node.type == "EMISSION":
        return Coefficients(light=_times(sockets.colour(node.inputs["Color"]), np.maximum(sockets.number(node.inputs["Strength"]), 0)))
    if node.type not in ("VOLUME_SCATTER", "VOLUME_ABSORPTION", "PRINCIPLED_VOLUME"):
        raise Unsupported(node, "it is no medium")
    density, colour = np.maximum(sockets.number(node.inputs["Density"]), 0), sockets.colour(node.inputs["Color"])
    if node.type == "VOLUME_ABSORPTION":
        return Coefficients(absorption=_times(np.maximum(1 - colour, 0), density))
    absorption, light = (0, 0, 0), (0, 0, 0)
    if node.type == "PRINCIPLED_VOLUME":
        thick, tint = sockets.grid(node, "Density Attribute"), sockets.grid(node, "Color Attribute")
        density = density if thick is None else density * np.maximum(thick.mean(-1), 0)
        colour = colour if tint is None else colour * np.maximum(tint, 0)
        kept = sockets.colour(node.inputs["Absorption Color"]) ** 0.5
        absorption = _times(np.maximum(1 - colour, 0) * np.maximum(1 - kept, 0), density)
        light = _light_of_principled(node, sockets)
    elif getattr(node, "phase", "HENYEY_GREENSTEIN") != "HENYEY_GREENSTEIN":
        sockets.tell(f"the phase function of '{node.name}' is not supported; Henyey-Greenstein takes its place")
    return Coefficients(_times(colour, density), absorption, np.clip(sockets.number(node.inputs["Anisotropy"]), -0.99, 0.99), light)


def medium_of(node, space, pixels_of, ray, owner, tell):
    """(the Coefficients or the VaryingMedium of a volume shader's node in a VolumeSpace, the kinds of coordinates that it hangs on); None:
    in no place that is known. pixels_of, ray, owner: as places of nodes have them. tell(text): what is left out. Raises Unsupported."""
    told = set()

    def at(places):
        place = VolumePlace(space, places, pixels_of, ray, owner)
        found = coefficients(node, _Sockets(Evaluator(place), told.add))
        return found.times(np.float32(space.density)) if space else found, place

    probes = space.random_places(PROBES) if space else np.zeros((1, 3), np.float32)
    found, place = at(probes)
    if not place.is_uniform:
        def values_at(places):
            return at(places)[0].values(len(places))

        is_of_voxels = AT_VOXELS and space.lattice and place.asked == {"GRID"}
        lattice, error = (space.lattice, 0) if is_of_voxels else lattice_for(space, values_at)
        found = Coefficients.of_values(lattice.sampled(values_at))
        _tell_of_colours(found, told.add)
        if bpy.app.version < WITH_BOXES and space.lattice and _has_border(found):
            told.add("its volume is not empty where its grids are; it fills the box around them, in this version of Cycles somewhat more")
        if error > COARSE:
            told.add(f"its volume varies between the places of its grid by {100 * error:.0f} % of its mean in the mean, which it has "
                     f"{' x '.join(map(str, lattice.shape))} of")
    for text in sorted(told):
        tell(text)
    # Rows of an even medium are alike; missing attributes make one for each place.
    return Coefficients.of_values(found.values()[0]) if place.is_uniform else VaryingMedium(found, lattice), place.asked


def _has_border(found):
    """Whether what nodes gave on a lattice is more than nothing in its first place, where grids have nothing."""
    return any(part[0].max() > UNEVEN * part.mean() for part in (found.scattering, found.absorption, found.light))


def _tell_of_colours(found, tell):
    """Warns where more than the density and the emission varies."""
    parts = np.concatenate((found.scattering, found.absorption), axis=1)
    density = parts.sum(-1)
    mean = parts.sum(0, dtype=float) / max(density.sum(dtype=float), 1e-30)
    stray = np.abs(parts - density[:, None] * mean).sum(0, dtype=float).max() / max(density.sum(dtype=float), 1e-30)
    if stray > UNEVEN:
        tell("the colour of its volume varies; all of it has the mean colour")
    amount = found.scattering.sum(-1)
    if amount.any() and np.ptp(found.g[amount > 0]) > UNEVEN:
        tell("the anisotropy of its volume varies; all of it has the mean")


def _volume(material):
    output = flat_output(tree_of(material)) if tree_of(material) else None
    return output and output.inputs["Volume"]


def has_volume(material):
    """Whether a material has a volume, supported or not."""
    volume = _volume(material)
    return volume is not None and volume.is_linked


def _may_vary(material):
    """Whether a material has a volume that may hang on the place."""
    volume = _volume(material)
    waiting, seen = [volume] if volume else [], set()
    while waiting:
        for node in [link.from_node for link in waiting.pop().links]:
            if node.type.startswith("TEX_") or node.type == "NEW_GEOMETRY":
                return True
            if node.path not in seen:
                seen.add(node.path)
                waiting += node.inputs
    return False


def is_smoke_domain(obj):
    """Whether an object holds the gas of a fluid simulation."""
    return any(m.type == "FLUID" and m.fluid_type == "DOMAIN" and m.domain_settings.domain_type == "GAS" for m in obj.modifiers)


class Varying:
    """Counts the instances whose volumes may hang on the place."""

    def __init__(self):
        self._known, self._count = {}, 0

    def add(self, materials):
        """An instance of these, by their names."""
        for name, material in materials.items():
            if name not in self._known:
                self._known[name] = _may_vary(material)
        self._count += any(self._known[name] for name in materials)

    def add_volume(self):
        """A volume object."""
        self._count += 1

    def most_places(self, is_preview):
        """The most places that the lattice of one instance may have."""
        return most_of_each(self._count, is_preview)
