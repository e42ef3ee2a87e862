"""Scattering, absorption and emission of volumes, per unit of length."""

import numpy as np

from .export_shaders import numbers

# Absorption per unit of length of what shines: pbrt's media shine by as much as they absorb. A hundred units dim by a thousandth.
LEAST_ABSORPTION = 1e-5

# The largest coefficient: nodes may give any number, and products of two of this size are finite in single precision.
MOST = 1e15


def _usable(values):
    """Values that nodes gave; what is no number, as of infinity times 0, is 0."""
    return np.nan_to_num(np.minimum(values, MOST)).astype(np.float32)


class Coefficients:
    """Scattering and absorption of a medium per unit of length, and the radiance that it adds on that: (3,) in R, G, B, or (n, 3) at places;
    g: the mean cosine of scattering, () or (n,)."""

    def __init__(self, scattering=(0, 0, 0), absorption=(0, 0, 0), g=0.0, light=(0, 0, 0)):
        self.scattering, self.absorption, self.light = (_usable(part) for part in (scattering, absorption, light))
        self.g = np.asarray(g, np.float32)

    def plus(self, other):
        """The sum, with the mean of both cosines by how much each scatters."""
        own, others = self.scattering.sum(-1), other.scattering.sum(-1)
        g = (self.g * own + other.g * others) / np.maximum(own + others, 1e-30)
        return Coefficients(self.scattering + other.scattering, self.absorption + other.absorption, g, self.light + other.light)

    def times(self, share):
        """All of it times a factor, () or (n,)."""
        scattering, absorption, light = (part * share[..., None] for part in (self.scattering, self.absorption, self.light))
        return Coefficients(scattering, absorption, self.g, light)

    def values(self, count=None):
        """(n, 10): all of it, one place after the other; count: n of what is the same everywhere."""
        rows = [self.scattering, self.absorption, self.light, self.g[..., None]]
        count = count or max((len(row) for row in rows if row.ndim > 1), default=1)
        return np.concatenate([np.broadcast_to(row, (count, row.shape[-1])) for row in rows], axis=1)

    @staticmethod
    def of_values(values):
        """Coefficients again, of the rows that `values` gives, or of one."""
        return Coefficients(values[..., :3], values[..., 3:6], values[..., 9], values[..., 6:9])

    def text(self):
        """Parameters of pbrt's homogeneous medium."""
        shines = self.light.max() > 0
        absorption = np.maximum(self.absorption, LEAST_ABSORPTION) if shines else self.absorption
        light = f' "rgb Le" [{numbers(self.light / absorption)}]' if shines else ""
        return f'"rgb sigma_s" [{numbers(self.scattering)}] "rgb sigma_a" [{numbers(absorption)}] "float g" {self.g:.9g}{light}'
