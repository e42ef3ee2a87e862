"""Results of baking a socket: constants and images."""

import itertools

import numpy as np

_numbers = itertools.count(1)  # of names, which are unique among all exports


class BakedImage:
    """Pixels that no image of Blender has: `values`, (h, w, 3) float32 from the top, of which numbers take a third of the memory."""

    def __init__(self, values):
        """values: (h, w, 1 or 3)."""
        self.name_full, self.bytes = f"baked {next(_numbers)}", values.nbytes
        self.values = np.broadcast_to(values, (*values.shape[:2], 3))


class Layout:
    """The part of the UV plane that an image shows: (u, v) from `low` on, `extent` wide; beyond it, it `wrap`s."""

    def __init__(self, low, extent, wrap):
        self.low, self.extent, self.wrap = np.array(low, float), np.array(extent, float), wrap

    def is_unit_square(self):
        return bool((self.low == 0).all() and (self.extent == 1).all())

    def mapping(self):
        """Scale and offset of (u, v), as Value has them."""
        return (*(1 / self.extent), *(-self.low / self.extent))


class Baked:
    """The result: a constant, or an image and its layout; the names of the UV maps that it reads. is_cut: it repeats where the nodes
    do not. is_mean: whether they hang on the angle of sight, and this is the mean. kinds: of coordinates on a body that the nodes have
    asked for."""

    def __init__(self, constant=None, image=None, layout=None, uv_maps=(), is_cut=False, kinds=(), is_mean=False):
        self.constant, self.image, self.layout, self.uv_maps, self.is_cut = constant, image, layout, tuple(uv_maps), is_cut
        self.kinds, self.is_mean = frozenset(kinds), is_mean
