"""Volumes of materials as even media, and which of them a place is in."""

import functools

from mathutils import Vector

from .export_shaders import numbers
from .shader_nodes.unsupported import Unsupported

MOST_CROSSINGS = 1000  # of a mesh by a ray: one that is caught between faces must end


class Coefficients:
    """Scattering and absorption of an even medium per unit of length, each in R, G, B; g: the mean cosine of scattering."""

    def __init__(self, scattering=(0, 0, 0), absorption=(0, 0, 0), g=0.0):
        self.scattering, self.absorption, self.g = tuple(scattering), tuple(absorption), g

    def plus(self, other):
        """The sum, with the mean of both cosines by how much each scatters."""
        weights = sum(self.scattering), sum(other.scattering)
        g = (self.g * weights[0] + other.g * weights[1]) / sum(weights) if sum(weights) > 0 else 0.0
        return Coefficients([a + b for a, b in zip(self.scattering, other.scattering)],
                            [a + b for a, b in zip(self.absorption, other.absorption)], g)


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
    if node.type not in ("VOLUME_SCATTER", "VOLUME_ABSORPTION", "PRINCIPLED_VOLUME"):
        raise Unsupported(node, "it is no even medium")
    density = max(number_of(node.inputs["Density"]), 0)
    colour = [max(c, 0) for c in colour_of(node.inputs["Color"])]
    if node.type == "VOLUME_ABSORPTION":
        return Coefficients(absorption=[max(1 - c, 0) * density for c in colour])
    scattering, absorption = [c * density for c in colour], (0, 0, 0)
    g = number_of(node.inputs["Anisotropy"])
    if node.type == "PRINCIPLED_VOLUME":
        kept = [max(c, 0) ** 0.5 for c in colour_of(node.inputs["Absorption Color"])]
        absorption = [max(1 - c, 0) * max(1 - k, 0) * density for c, k in zip(colour, kept)]
        if max(number_of(node.inputs[name]) for name in ("Emission Strength", "Blackbody Intensity")) > 0:
            tell(f"the light of '{node.name}' is not supported and left out")
    elif getattr(node, "phase", "HENYEY_GREENSTEIN") != "HENYEY_GREENSTEIN":
        tell(f"the phase function of '{node.name}' is not supported; Henyey-Greenstein takes its place")
    return Coefficients(scattering, absorption, min(max(g, -0.99), 0.99))


def has_volume(material):
    """Whether a material has a volume, supported or not."""
    output = material.node_tree.get_output_node("CYCLES") if material and material.use_nodes and material.node_tree else None
    return output is not None and output.inputs["Volume"].is_linked


class Media:
    """Writes even media into `out`, each once."""

    def __init__(self, out):
        self.out, self._coefficients, self._sums = out, {}, {}

    def add(self, found):
        """The name of a medium of these Coefficients."""
        name = f"medium {len(self._coefficients)}"
        self._coefficients[name] = found
        self.out.write(f'MakeNamedMedium "{name}" "string type" "homogeneous" "rgb sigma_s" [{numbers(found.scattering)}] '
                       f'"rgb sigma_a" [{numbers(found.absorption)}] "float g" {found.g:.9g}\n')
        return name

    def sum(self, names):
        """The name of the medium where all these are at once, as in Cycles; "" of none."""
        if len(names) < 2:
            return "".join(names)
        if names not in self._sums:
            self._sums[names] = self.add(functools.reduce(Coefficients.plus, (self._coefficients[name] for name in names)))
        return self._sums[names]


class Volumes:
    """Instances whose materials have media. `add` them all before asking where a place is."""

    def __init__(self):
        self._found = []

    def add(self, obj, matrix, medium):
        self._found.append((obj, matrix.copy(), medium))

    def media_at(self, place, but=None):
        """The names of the media of all that hold a place of the world; `but`: an object that does not count."""
        return tuple(medium for obj, matrix, medium in self._found
                     if (but is None or obj.name_full != but.name_full) and _holds(obj, matrix, place))


def _holds(obj, matrix, place):
    """Whether an object's closed mesh holds a place: a ray from there crosses it an odd number of times."""
    if abs(matrix.determinant()) < 1e-30 or obj.type != "MESH":
        return False
    origin, direction = matrix.inverted() @ place, Vector((0.5773, 0.5411, 0.6115))
    step = 1e-5 * max(max(obj.dimensions), 1e-6)
    for crossings in range(MOST_CROSSINGS):
        is_hit, where, _, _ = obj.ray_cast(origin, direction)
        if not is_hit:
            return crossings % 2 == 1
        origin = where + direction * step
    return False
