"""Gradient noise (K. Perlin, "Improving Noise", SIGGRAPH 2002) in one to four dimensions, of Blender's cells and scales."""

import itertools

import numpy as np

from .hashing import hashed
from .lattice import Lattice

# Factors that bring each dimension's noise near to [-1, 1].
SCALES = {1: 0.25, 2: 0.6616, 3: 0.9820, 4: 0.8344}


def _directions(dimensions):
    """d arrays (2^k,): the components of the gradients that a hash chooses among, by its last k bits."""
    h = np.arange({1: 16, 2: 8, 3: 16, 4: 32}[dimensions])
    sign = [1.0 - 2.0 * (h >> bit & 1) for bit in range(4)]
    gradients = np.zeros((dimensions, len(h)))
    if dimensions == 1:
        gradients[0] = sign[3] * (1 + (h & 7))
    elif dimensions == 2:
        first = np.where(h < 4, 0, 1)
        gradients[first, h] = sign[0]
        gradients[1 - first, h] = 2 * sign[1]
    elif dimensions == 3:
        gradients[np.where(h < 8, 0, 1), h] += sign[0]
        gradients[np.where(h < 4, 1, np.where((h == 12) | (h == 14), 0, 2)), h] += sign[1]
    else:
        gradients[np.where(h < 24, 0, 1), h] = sign[0]
        gradients[np.where(h < 16, 1, 2), h] = sign[1]
        gradients[np.where(h < 8, 2, 3), h] = sign[2]
    return list(gradients.astype(np.float32))


_DIRECTIONS = {dimensions: _directions(dimensions) for dimensions in SCALES}


def _gradients(cells):
    """d arrays (m,): the gradients at corners, d arrays (m,), of few directions, as their hashes choose."""
    directions = _DIRECTIONS[len(cells)]
    chosen = hashed(*(axis.view(np.uint32) for axis in cells)) & np.uint32(len(directions[0]) - 1)
    return [component.take(chosen, mode="clip") for component in directions]


def signed_noise(p):
    """(n,) in about [-1, 1] at (n, d)."""
    axes = np.ascontiguousarray(np.atleast_2d(np.asarray(p, np.float32)).T)
    dimensions = len(axes)
    cells = np.floor(axes)
    local = axes - cells
    lattice = Lattice(list(cells.astype(np.int32)), 0, 1, _gradients)
    # Distances along each axis from the near side and the far one. Places on the near side have nothing of the far one, as on the
    # plane of UV coordinates.
    sides = [(t, t - 1) if t.any() else (t,) for t in local]
    values = {}
    for corner in itertools.product(*(range(len(side)) for side in sides)):
        values[corner] = sum(gradient * side[k] for gradient, side, k in zip(lattice.at(corner), sides, corner))
    for axis in reversed(range(dimensions)):
        if len(sides[axis]) == 2:
            t = local[axis]
            fade = t * t * t * (t * (t * 6 - 15) + 10)
            values = {corner[:-1]: value + fade * (values[(*corner[:-1], 1)] - value) for corner, value in values.items() if not corner[-1]}
        else:
            values = {corner[:-1]: value for corner, value in values.items()}
    return np.float32(SCALES[dimensions]) * values[()]


# Share of the whole that the last octaves may have together and be left out: half a step of 8 bits.
LEAST_SHARE = 1 / 512


def fractal(p, detail, roughness, lacunarity=2.0):
    """(n,) in about [-1, 1]: the mean of octaves, each `roughness` as strong as the one before it; of the last one, the
    share that `detail` has behind the point."""
    detail = np.clip(np.asarray(detail, np.float32), 0, 15)
    roughness = np.maximum(np.asarray(roughness, np.float32), 0)
    whole = np.floor(detail)
    share = detail - whole
    octaves = int(np.ceil(detail.max())) + 1
    strengths = [roughness**octave for octave in range(octaves)]
    # The mean of the whole octaves, and one with the next octave, each by its share.
    weights, with_next = (sum(np.where(octave <= limit, strength, 0) for octave, strength in enumerate(strengths))
                          for limit in (whole, whole + 1))
    of_octave = [strength * (np.where(octave <= whole, (1 - share) / weights, 0) + np.where(octave <= whole + 1, share / with_next, 0))
                 for octave, strength in enumerate(strengths)]
    total, frequency = np.float32(0), np.float32(1)
    for octave, weight in enumerate(of_octave):
        if sum(np.max(rest) for rest in of_octave[octave:]) < LEAST_SHARE:
            break
        total = total + weight.astype(np.float32) * signed_noise(p * np.asarray(frequency)[..., None])
        frequency = frequency * lacunarity
    return total
