"""Media of pbrt, each written once where it is used, and which of them a place is in."""

import functools

import numpy as np

from .coefficients import Coefficients
from .placement import matrix_text
from .shader_nodes.light_path import RAYS
from .volume_lattice import moved

MOST_TRIED = 32  # vertices of which it is asked whether they stick out
INWARDS = 0.999  # of the way from the middle, as volumes may touch


class VaryingMedium:
    """Coefficients whose values are (n, 3), and (n,) of g, at the places of a Lattice. matrix: 4x4 from there to the world, None as long as
    it stands nowhere."""

    def __init__(self, found, lattice, matrix=None):
        self.found, self.lattice, self.matrix = found, lattice, matrix

    def plus(self, other):
        """The sum with another one, or with even Coefficients, where both are."""
        if isinstance(other, VaryingMedium):
            to_other = np.linalg.inv(other.matrix) @ self.matrix
            places = self.lattice.places(0, self.lattice.count()) @ to_other[:3, :3].T + to_other[:3, 3]
            other = other.found.of_values(other.lattice.interpolated(places, lambda numbers: other.found.values()[numbers]))
        return VaryingMedium(self.found.plus(other), self.lattice, self.matrix)

    def text(self, name, more=""):
        """pbrt's grid, with `more` parameters: of one colour, as dense at each place as all channels are, and of any emission."""
        density = (self.found.scattering + self.found.absorption).sum(-1)
        whole = density.sum(dtype=float) or 1.0
        scattering, absorption = (part.sum(0, dtype=float) / whole for part in (self.found.scattering, self.found.absorption))
        amount = self.found.scattering.sum(-1)
        g = float((self.found.g * amount).sum() / max(amount.sum(), 1e-30))
        light = f' "rgb emission" [{_short(self.found.light)}]' if self.found.light.any() else ""
        nx, ny, nz = self.lattice.shape
        low, high = (" ".join(f"{v:.9g}" for v in corner) for corner in (self.lattice.low, self.lattice.high))
        return (f'AttributeBegin\nTransform [{matrix_text(self.matrix)}]\nMakeNamedMedium "{name}" "string type" "uniformgrid" '
                f'"integer nx" {nx} "integer ny" {ny} "integer nz" {nz} "point3 p0" [{low}] "point3 p1" [{high}] '
                f'"rgb sigma_s" [{_short(scattering)}] "rgb sigma_a" [{_short(absorption)}] "float g" {g:.9g}{light} '
                f'"float density" [{_short(density)}]{more}\nAttributeEnd\n')


def _short(values):
    """Numbers of single precision that are looked up between: five digits are enough."""
    return " ".join(map("{:.5g}".format, np.asarray(values).ravel().tolist()))


class Media:
    """Writes media into `out`, each once. is_seen: whether the camera's rays, straight on, find them."""

    is_seen = True

    def __init__(self, out):
        self.out, self._found, self._sums, self._placed, self._written = out, {}, {}, {}, set()

    def add(self, found):
        """The name of a medium of even Coefficients, or of a VaryingMedium."""
        name = f"medium {len(self._found)}"
        self._found[name] = found
        if isinstance(found, Coefficients):
            self._write(name)
        return name

    def varies(self, name):
        return isinstance(self._found.get(name), VaryingMedium)

    def placed(self, name, matrix):
        """The name of a medium as it stands in the world by an object's matrix."""
        if not self.varies(name):
            return name
        matrix = np.array(matrix)
        key = name, matrix.tobytes()
        if key not in self._placed:
            found = self._found[name]
            self._placed[key] = self.add(VaryingMedium(found.found, found.lattice, matrix))
        return self._placed[key]

    def sum(self, names):
        """The name of the medium where all these are at once, in any order, as in Cycles; "" of none. It is written then."""
        # A VaryingMedium is the sum's first part.
        names = tuple(sorted(names, key=lambda name: (not self.varies(name), name)))
        if len(names) > 1 and names not in self._sums:
            self._sums[names] = self.add(functools.reduce(lambda a, b: a.plus(b), (self._found[name] for name in names)))
        name = self._sums[names] if len(names) > 1 else "".join(names)
        if name:
            self._write(name)
        return name

    def _write(self, name):
        if name in self._written:
            return
        self._written.add(name)
        found = self._found[name]
        hidden = "" if self.is_seen else ' "bool hiddenfromcamera" true'
        self.out.write(found.text(name, hidden) if self.varies(name)
                       else f'MakeNamedMedium "{name}" "string type" "homogeneous" {found.text()}{hidden}\n')


class Volumes:
    """Instances whose materials have media. `add` them all before asking where a place is. everywhere: names of media that all places are
    in."""

    def __init__(self, everywhere=()):
        self._everywhere = everywhere
        self._solids, self._bodies, self._inverses, self._is_told = {}, [], [], False

    def add(self, obj, make_solid, matrix, medium, rays):
        """make_solid: gives the Solid or Box of the object, which instances share; rays: the kinds that see it."""
        if abs(matrix.determinant()) < 1e-30:
            return
        key = obj.data.as_pointer()
        if key not in self._solids:
            self._solids[key] = make_solid()
        self._bodies.append((obj.name_full, self._solids[key], medium, set(rays)))
        self._inverses.append(np.array(matrix.inverted()))

    def __bool__(self):
        """Whether there is a place in a medium."""
        return bool(self._bodies or self._everywhere)

    @functools.cached_property
    def _boxes(self):
        """(inverse matrix, low and high corner in its own space) of each body."""
        solids = [solid for _, solid, _, _ in self._bodies]
        return np.array(self._inverses), np.array([s.low for s in solids]), np.array([s.high for s in solids])

    def around(self, obj, matrix, warn):
        """The names of the media that an object stands in with its middle and all its outline: what is within its own volume is not around
        it. matrix: its own, to the world; warn(text): is told once where one sticks out of another."""
        corners, matrix = np.array([tuple(corner) for corner in obj.bound_box]), np.array(matrix)
        middle = corners.mean(0)
        if obj.type == "MESH":
            vertices = obj.data.vertices
            corners = np.array([tuple(vertices[i].co) for i in range(0, len(vertices), -(-len(vertices) // MOST_TRIED))])
        places = moved(middle + INWARDS * (corners - middle), matrix)
        outline = [set(self.media_at(place, obj.name_full)) for place in places]
        if not self._is_told and any(media != outline[0] for media in outline):
            self._is_told = True
            warn(f"volumes that overlap in part, as '{obj.name}' and another one, are not right there")
        return tuple(name for name in self.media_at(moved(middle, matrix), obj.name_full) if all(name in media for media in outline))

    def media_at(self, place, but="", rays=RAYS):
        """The names of the media of all that hold a place of the world and that one of these kinds of rays sees; `but`: the
        name of an object that does not count."""
        if not self._bodies:
            return self._everywhere
        inverses, low, high = self._boxes
        # Few boxes hold the place; only these are worth rays.
        places = inverses[:, :3, :3] @ np.array(place) + inverses[:, :3, 3]
        found = []
        for index in np.flatnonzero(((low <= places) & (places <= high)).all(1)):
            name, solid, medium, seen_by = self._bodies[index]
            if name != but and seen_by.intersection(rays) and solid.holds(places[index]):
                found.append(medium)
        return (*self._everywhere, *found)
