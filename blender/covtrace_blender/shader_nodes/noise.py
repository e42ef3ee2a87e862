"""Gradient noise (K. Perlin, "Improving Noise", SIGGRAPH 2002) in one to four dimensions, of Blender's cells and scales."""

import itertools

import numpy as np

from .hashing import hashed
from .lattice import Lattice

# Factors that bring each dimension's noise near to [-1, 1].
SCALES = {1: 0.25, 2: 0.6616, 3: 0.9820, 4: 0.8344}


def _signed(h, bit):
    return np.where(h & np.uint32(bit), np.float32(-1), np.float32(1))


def _gradients(cells):
    """(m, d): the gradient at each corner (m, d), of few directions, as its hash chooses."""
    dimensions = cells.shape[1]
    h = hashed(*(cells[:, i].astype(np.uint32) for i in range(dimensions)))
    gradients = np.zeros(cells.shape, np.float32)
    rows = np.arange(len(cells))
    if dimensions == 1:
        h = h & np.uint32(15)
        gradients[:, 0] = _signed(h, 8) * (1 + (h & np.uint32(7)))
    elif dimensions == 2:
        h = h & np.uint32(7)
        first = np.where(h < 4, 0, 1)
        gradients[rows, first] = _signed(h, 1)
        gradients[rows, 1 - first] = 2 * _signed(h, 2)
    elif dimensions == 3:
        h = h & np.uint32(15)
        gradients[rows, np.where(h < 8, 0, 1)] = _signed(h, 1)
        gradients[rows, np.where(h < 4, 1, np.where((h == 12) | (h == 14), 0, 2))] = _signed(h, 2)
    else:
        h = h & np.uint32(31)
        gradients[rows, np.where(h < 24, 0, 1)] = _signed(h, 1)
        gradients[rows, np.where(h < 16, 1, 2)] = _signed(h, 2)
        gradients[rows, np.where(h < 8, 2, 3)] = _signed(h, 4)
    return gradients


def signed_noise(p):
    """(n,) in about [-1, 1] at (n, d)."""
    p = np.atleast_2d(np.asarray(p, np.float32))
    dimensions = p.shape[1]
    cells = np.floor(p)
    local = np.ascontiguousarray((p - cells).T)
    lattice = Lattice(cells.astype(np.int64), 0, 1, _gradients)
    axes = []  # for each: (side, weight, distance from it) of its near side and its far one
    for t in local:
        fade = t * t * t * (t * (t * 6 - 15) + 10)
        axes.append([(0, 1 - fade, t), (1, fade, t - 1)])
        if not t.any():  # as on the plane of UV coordinates: far sides have no weight
            axes[-1].pop()
    total = np.zeros(len(p), np.float32)
    for corner in itertools.product(*axes):
        gradient = np.ascontiguousarray(lattice.at([side for side, _, _ in corner]).T)
        weight, slope = np.float32(SCALES[dimensions]), np.float32(0)
        for (_, share, distance), g in zip(corner, gradient):
            weight = weight * share
            slope = slope + g * distance
        total += weight * slope
    return total


def fractal(p, detail, roughness, lacunarity=2.0):
    """(n,) in about [-1, 1]: the mean of octaves, each `roughness` as strong as the one before it; of the last one, the
    share that `detail` has behind the point."""
    detail = np.clip(np.asarray(detail, np.float32), 0, 15)
    roughness = np.maximum(np.asarray(roughness, np.float32), 0)
    whole = np.floor(detail)
    share = detail - whole
    frequency, strength, total, weight, value = 1.0, np.float32(1), 0, 0, 0
    for octave in range(int(whole.max()) + 2):
        is_needed = octave <= whole + (share > 0)
        if not is_needed.any():
            break
        before, before_weight = total, weight
        total = total + strength * signed_noise(p * np.asarray(frequency)[..., None])
        weight = weight + strength
        mean = total / weight
        value = np.where(octave <= whole, mean, np.where(octave == whole + 1, (1 - share) * before / np.where(
            np.asarray(before_weight) > 0, before_weight, 1) + share * mean, value))
        strength = strength * roughness
        frequency = frequency * lacunarity
    return value
