"""Values that hang on the place within a volume, on a lattice of places."""

import itertools

import numpy as np

from .parts import PART, by_parts

# Places of a lattice: from 16 along each side of a cube to 128, in viewports 64. The finest takes a second for each octave of a noise,
# and 10 MB of a file, 40 where it shines; Cycles takes ten steps through a box.
FEWEST, MOST, MOST_OF_PREVIEWS = 1 << 12, 1 << 21, 1 << 18
SHARED = 8  # lattices of the finest kind that all of a scene may have together, as each instance has one in its file
WITH_BORDER = 1.1  # times as many places has the finest lattice of a cube with those beyond its sides
FINER = 8  # times as many places in the next finer one
PROBES = 2048
# Mean error between places, of the mean, at which a finer lattice is not worth its memory. Errors of both signs cancel along rays: of three
# noises at four lattices each those of columns through the box were a sixth to a half of it.
TOLERANCE = 0.04


def most_of_each(count, is_preview):
    """The most places that the lattice of each of `count` instances may have."""
    most = MOST_OF_PREVIEWS if is_preview else MOST
    return max(FEWEST, min(most, SHARED * most // max(count, 1)))


class VolumeSpace:
    """The box that a volume fills, in its object's space: low and high are its corners. texture_space: (least corner, size) of Generated
    coordinates. matrix: 4x4 to the world; None where there is none that is the only one. grids: {name of an attribute: function of (n, 3)
    places to (n, 3)}. most: places of a lattice; lattice: the coarsest one that is worth trying, or None. density: a factor of all
    coefficients."""

    def __init__(self, low, high, texture_space, matrix=None, grids=None, most=MOST, lattice=None, density=1.0):
        self.low, self.high, self.texture_space = np.array(low, float), np.array(high, float), texture_space
        self.matrix, self.grids, self.most, self.lattice, self.density = matrix, grids or {}, most, lattice, density

    def key(self):
        """Equal for spaces in which all is alike but the world."""
        return (*self.low, *self.high, *(tuple(part) for part in self.texture_space), self.most, self.density, *map(id, self.grids.values()))

    def random_places(self, count):
        return (self.low + np.random.default_rng(0).random((count, 3)) * (self.high - self.low)).astype(np.float32)


def moved(places, matrix):
    """(n, 3) places by a 4x4 matrix."""
    return places @ matrix[:3, :3].T + matrix[:3, 3]


class Lattice:
    """Places in the middles of nearly cubic cells that fill a box, and one more beyond each of its sides: between places values are linear,
    and at the box itself they are not to fall. shape: numbers of places along x, y, z, `low` and `high`: corners of the cells."""

    def __init__(self, low, high, count):
        size = np.maximum(high - low, 1e-6 * max((high - low).max(), 1e-30))
        cell = np.cbrt(size.prod() / count)
        # A flat side leaves its places to the others.
        for _ in range(3):
            flat = size < cell
            if flat.any() and not flat.all():
                cell = (size[~flat].prod() / count) ** (1 / (~flat).sum())
        cells = np.maximum(np.round(size / cell), 1).astype(int)
        self.cell, self.shape = size / cells, tuple(int(n) + 2 for n in cells)
        self.low, self.high = low - self.cell, low + size + self.cell

    @classmethod
    def of_cells(cls, low, cell, shape):
        """The one of these cells, of which the first begins at `low`."""
        found = cls.__new__(cls)
        found.low, found.cell, found.shape = np.array(low, float), np.array(cell, float), tuple(int(n) for n in shape)
        found.high = found.low + found.cell * found.shape
        return found

    def places(self, first, end):
        """(end - first, 3) of those with these numbers; x changes fastest."""
        z, y, x = np.unravel_index(np.arange(first, end), self.shape[::-1])
        return (self.low + (np.column_stack((x, y, z)) + 0.5) * self.cell).astype(np.float32)

    def count(self):
        return int(np.prod(self.shape))

    def interpolated(self, places, values_of):
        """(n, d) at (n, 3) places of the box, of `values_of(numbers of lattice places)`; beyond the lattice that of its border."""
        at = np.clip((places - self.low) / self.cell - 0.5, 0, np.array(self.shape) - 1.0)
        first = np.minimum(at.astype(int), np.array(self.shape) - 2)
        share, total = at - first, 0
        for corner in itertools.product((0, 1), repeat=3):
            weight = np.prod(np.where(corner, share, 1 - share), axis=1)
            total = total + weight[:, None] * values_of(np.ravel_multi_index((first + corner)[:, ::-1].T, self.shape[::-1]))
        return total

    def sampled(self, values_at):
        """(count, d) float32 of `values_at((n, 3) places)`."""
        found = [None] * -(-self.count() // PART)

        def work(first, end):
            found[first // PART] = values_at(self.places(first, end)).astype(np.float32)

        by_parts(work, self.count())
        return np.concatenate(found)


def lattice_for(space, values_at):
    """(the coarsest Lattice of a VolumeSpace between whose places `values_at((n, 3) places)` hardly differs from what is linear, or the finest
    that it may have; the mean error between its places as a share of the mean)."""
    probes = space.random_places(PROBES)
    exact = values_at(probes)
    mean = np.maximum(np.abs(exact).mean(0), 1e-30)
    lattice = space.lattice or Lattice(space.low, space.high, FEWEST)
    count = space.lattice.count() if space.lattice else FEWEST
    while True:

        def values_of(numbers):
            z, y, x = np.unravel_index(numbers, lattice.shape[::-1])
            return values_at((lattice.low + (np.column_stack((x, y, z)) + 0.5) * lattice.cell).astype(np.float32))

        error = float((np.abs(lattice.interpolated(probes, values_of) - exact).mean(0) / mean).max())
        count *= FINER
        finer = Lattice(space.low, space.high, count)
        # Flat and thin boxes have most of their places beyond their sides.
        if error <= TOLERANCE or count > space.most or finer.count() > WITH_BORDER * space.most:
            return lattice, error
        lattice = finer
