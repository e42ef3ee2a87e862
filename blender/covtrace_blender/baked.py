"""Results of baking a socket: constants and images."""

import itertools

import numpy as np

from .values import Value

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
    """The result: a constant, or images and their layout; the names of the UV maps that it reads. angles: what tells at which angles of
    sight these are, as angles.py has it, whose constants are rows, or None. is_cut: it repeats where the nodes do not. is_mean: whether they
    hang on the angle of sight, and this is the mean. kinds: of coordinates on a body that the nodes have asked for."""

    def __init__(self, constant=None, images=(), layout=None, uv_maps=(), is_cut=False, kinds=(), is_mean=False, angles=None):
        self.constant, self.images, self.layout, self.uv_maps, self.is_cut = constant, tuple(images), layout, tuple(uv_maps), is_cut
        self.kinds, self.is_mean, self.angles = frozenset(kinds), is_mean, angles

    @property
    def image(self):
        """That of what is one alone; None of constants."""
        return self.images[0] if self.images else None

    def value(self):
        """The same as a Value."""
        if self.images:
            values = [Value(image=image, mapping=self.layout.mapping(), wrap=self.layout.wrap) for image in self.images]
        else:
            values = [_constant(row) for row in (self.constant if self.angles else [self.constant])]
        return self.angles.value(values) if self.angles else values[0]


def _constant(value):
    value = np.asarray(value)
    return Value(tuple(float(v) for v in value) if value.ndim else float(value))


def images_of(values, channels):
    """BakedImages of (h, w, k * channels) values of k images."""
    return [BakedImage(values[..., first:first + channels]) for first in range(0, values.shape[-1], channels)]


def channels_of(value):
    """3 of a vector, or those at many places, which are more than 3; 1 of a number."""
    return 3 if value.shape[-1:] == (3,) else 1
