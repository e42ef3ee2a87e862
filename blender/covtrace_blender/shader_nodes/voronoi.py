"""Cells around random points (S. Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996), of Blender's points."""

import itertools

import bpy
import numpy as np

from .hashing import hashed_numbers, hashed_place, permuted_numbers
from .lattice import Lattice

# Lengths of a vector, whose components are arrays each.
METRICS = {
    "EUCLIDEAN": lambda d, exponent: np.sqrt(sum(x * x for x in d)),
    "MANHATTAN": lambda d, exponent: sum(np.abs(x) for x in d),
    "CHEBYCHEV": lambda d, exponent: np.maximum.reduce([np.abs(x) for x in d]),
    "MINKOWSKI": lambda d, exponent: sum(np.abs(x) ** exponent for x in d) ** (1 / exponent),
}


def _is_permuted():
    """Whether cells have the numbers of Blender 5."""
    return bpy.app.version >= (5, 0, 0)


def _point_in(cells):
    """d arrays in [0, 1]: the points of cells, d arrays (m,) of whole numbers."""
    if _is_permuted() and len(cells) > 1:
        return permuted_numbers(*cells)
    return hashed_place(*(axis.astype(np.float32) for axis in cells))


def _colour_of(cells):
    """Three arrays in [0, 1], of the same cells."""
    if _is_permuted() and len(cells) > 1:
        return permuted_numbers(*cells, *(np.zeros_like(cells[0]),) * (3 - len(cells)))[:3]
    return hashed_numbers(*(axis.astype(np.float32) for axis in cells))


class _Cells:
    """The cells about each place p (n, d), up to `reach` of them away, with their points; `jitter`: how far these are from the cells'
    corners."""

    def __init__(self, p, jitter, reach=1):
        axes = np.ascontiguousarray(np.asarray(p, np.float32).T)
        base = np.floor(axes)
        self.base, self._local, self._jitter = base.astype(np.int32), axes - base, np.asarray(jitter, np.float32)
        self._points = Lattice(list(self.base), -reach, reach, _point_in)
        # Cycles has the first axis vary fastest: of equally near points the first one counts.
        self.offsets = [offset[::-1] for offset in itertools.product(range(-reach, reach + 1), repeat=len(axes))]

    def away(self, offset):
        """Components, each (n,): the point of the cell `offset` beside that of p, as seen from p."""
        return [point * self._jitter + np.float32(k) - t for k, point, t in zip(offset, self._points.at(offset), self._local)]


def nearest(p, jitter, metric, is_second):
    """(distance (n,), colour (n, 3), position (n, d)) of the nearest point of each place, or of the second one."""
    cells = _Cells(p, jitter)
    first, second = (np.full(len(p), np.inf, np.float32) for _ in range(2))
    of_first, of_second = (np.zeros(len(p), np.int8) for _ in range(2))
    for number, offset in enumerate(cells.offsets):
        distance = metric(cells.away(offset))
        is_first = distance < first
        if is_second:
            is_later = distance < second
            np.copyto(of_second, number, where=is_later)
            np.copyto(of_second, of_first, where=is_first)
            second = np.maximum(first, np.minimum(second, distance))
        np.copyto(of_first, number, where=is_first)
        first = np.minimum(first, distance)
    found, distance = (of_second, second) if is_second else (of_first, first)
    owner = [base + offset.take(found) for base, offset in zip(cells.base, np.array(cells.offsets, np.int32).T)]
    jitter = np.asarray(jitter, np.float32)
    position = np.stack([axis + point * jitter for axis, point in zip(owner, _point_in(owner))], axis=-1).astype(np.float32)
    return distance, np.stack(_colour_of(owner), axis=-1), position


def smooth(p, jitter, metric, smoothness):
    """The same three as of the nearest point, which change smoothly from cell to cell; smoothness: above 0, to 0.5."""
    cells, smoothness = _Cells(p, jitter, reach=2), np.asarray(smoothness, np.float32)
    colours = Lattice(list(cells.base), -2, 2, _colour_of)
    found = None
    for offset in cells.offsets:
        away = cells.away(offset)
        values = [*colours.at(offset), *away]
        distance = metric(away)
        if found is None:
            found, nearest_so_far = [np.array(value, np.float32) for value in values], distance
            continue
        share = np.clip(0.5 + 0.5 * (nearest_so_far - distance) / smoothness, 0, 1)
        share = share * share * (3 - 2 * share)
        less = smoothness * share * (1 - share)
        nearest_so_far = nearest_so_far + (distance - nearest_so_far) * share - less
        less = less / (1 + 3 * smoothness)
        for old, value in zip(found, values):  # in place: it runs for hundreds of cells
            old += (value - old) * share
            old -= less
    return nearest_so_far, np.stack(found[:3], axis=-1), np.stack(found[3:], axis=-1) + np.asarray(p, np.float32)


def sphere_radius(p, jitter):
    """(n,): half of the way from the nearest point of each place to the point that is nearest to that one."""
    cells = _Cells(p, jitter)
    least, of_nearest = np.full(len(p), np.inf, np.float32), [np.zeros(len(p), np.int32) for _ in cells.base]
    for offset in cells.offsets:
        square = sum(x * x for x in cells.away(offset))
        for new, old in zip(offset, of_nearest):
            np.copyto(old, new, where=square < least)
        least = np.minimum(square, least)
    jitter = np.asarray(jitter, np.float32)
    owner = [base + k for base, k in zip(cells.base, of_nearest)]
    own = [point * jitter for point in _point_in(owner)]
    least = np.full(len(p), np.inf, np.float32)
    for offset in cells.offsets:
        if any(offset):
            other = _point_in([axis + np.int32(k) for axis, k in zip(owner, offset)])
            least = np.minimum(least, sum((point * jitter + np.float32(k) - o) ** 2 for point, k, o in zip(other, offset, own)))
    return np.sqrt(least) / 2


def distance_to_edge(p, jitter):
    """(n,): from each place to the nearest border between two cells."""
    cells = _Cells(p, jitter)
    least = np.full(len(p), np.inf, np.float32)
    closest = [np.zeros(len(p), np.float32) for _ in cells.base]
    for offset in cells.offsets:
        away = cells.away(offset)
        square = sum(x * x for x in away)
        is_nearer = square < least
        for new, old in zip(away, closest):
            np.copyto(old, new, where=is_nearer)
        least = np.minimum(square, least)
    border = np.full(len(p), np.inf, np.float32)
    for offset in cells.offsets:
        away = cells.away(offset)
        between = [a - c for a, c in zip(away, closest)]
        size = np.sqrt(sum(x * x for x in between))
        distance = sum(0.5 * (c + a) * x for c, a, x in zip(closest, away, between)) / np.maximum(size, 1e-30)
        np.minimum(border, distance, out=border, where=size > 1e-2)  # the closest point itself is no neighbour
    return border
