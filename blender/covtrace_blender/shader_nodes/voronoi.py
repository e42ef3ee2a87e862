"""Cells around random points (S. Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996), of Blender's points."""

import itertools

import numpy as np

from .hashing import hashed_number, hashed_vector
from .lattice import Lattice

# Lengths of a vector, whose components are arrays each.
METRICS = {
    "EUCLIDEAN": lambda d, exponent: np.sqrt(sum(x * x for x in d)),
    "MANHATTAN": lambda d, exponent: sum(np.abs(x) for x in d),
    "CHEBYCHEV": lambda d, exponent: np.maximum.reduce([np.abs(x) for x in d]),
    "MINKOWSKI": lambda d, exponent: sum(np.abs(x) ** exponent for x in d) ** (1 / exponent),
}


def _point_in(cells):
    """(n, d) in [0, 1]: the point of each cell (n, d)."""
    keys = list(cells.T.astype(np.float32))
    if len(keys) == 2:
        return np.stack([hashed_number(*keys), hashed_number(*keys, 1.0)], axis=-1)
    return hashed_vector(*keys)


class _Cells:
    """The cells about each place p (n, d), with their points; `jitter`: how far these are from the cells' corners."""

    def __init__(self, p, jitter):
        self.base = np.floor(p)
        self._local, self._jitter = (p - self.base).T, np.asarray(jitter, np.float32)
        self._points = Lattice(self.base.astype(np.int64), -1, 1, _point_in)
        # Cycles has the first axis vary fastest: of equally near points the first one counts.
        self.offsets = [offset[::-1] for offset in itertools.product((-1, 0, 1), repeat=p.shape[1])]

    def away(self, offset):
        """Components, each (n,): the point of the cell `offset` beside that of p, as seen from p."""
        points = self._points.at(offset).T
        return [np.float32(k) + point * self._jitter - t for k, point, t in zip(offset, points, self._local)]


def nearest(p, jitter, metric, is_second):
    """(distance (n,), colour (n, 3), position (n, d)) of the nearest point of each place, or of the second one."""
    cells = _Cells(p, jitter)
    first, second = (np.full(len(p), np.inf, np.float32) for _ in range(2))
    of_first, of_second = (np.zeros(len(p), int) for _ in range(2))
    for number, offset in enumerate(cells.offsets):
        distance = metric(cells.away(offset))
        is_first = distance < first
        is_later = ~is_first & (distance < second)
        second = np.where(is_first, first, np.where(is_later, distance, second))
        of_second = np.where(is_first, of_first, np.where(is_later, number, of_second))
        first, of_first = np.where(is_first, distance, first), np.where(is_first, number, of_first)
    found, distance = (of_second, second) if is_second else (of_first, first)
    owner = cells.base + np.array(cells.offsets, np.float32)[found]
    position = owner + _point_in(owner) * np.asarray(jitter, np.float32)[..., None]
    return distance, hashed_vector(*owner.T), position


def distance_to_edge(p, jitter):
    """(n,) distance of each place to the border of its cell."""
    cells = _Cells(p, jitter)
    least, closest = np.full(len(p), np.inf, np.float32), [np.zeros(len(p), np.float32) for _ in range(p.shape[1])]
    for offset in cells.offsets:
        away = cells.away(offset)
        square = sum(x * x for x in away)
        is_nearer = square < least
        least = np.where(is_nearer, square, least)
        closest = [np.where(is_nearer, new, old) for new, old in zip(away, closest)]
    border = np.full(len(p), np.inf, np.float32)
    for offset in cells.offsets:
        away = cells.away(offset)
        between = [a - c for a, c in zip(away, closest)]
        size = np.sqrt(sum(x * x for x in between))
        is_other = size > 1e-2  # the closest point itself is no neighbour
        distance = sum(0.5 * (c + a) * x for c, a, x in zip(closest, away, between)) / np.where(is_other, size, 1)
        border = np.where(is_other, np.minimum(border, distance), border)
    return border
