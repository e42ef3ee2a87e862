"""The nodes Noise and White Noise."""

import numpy as np

from .fractals import KINDS, Octaves
from .hashing import hashed_number, hashed_vector
from .noise import fractal, signed_noise
from .unsupported import Unsupported


def points(node, inputs, dimensions):
    """(n, d) places: x, y, z, the fourth axis being W; the only one being W, too."""
    parts = []
    if dimensions > 1:
        parts = list(np.moveaxis(inputs.coordinates()[..., :min(dimensions, 3)], -1, 0))
    if dimensions in (1, 4):
        parts.append(inputs.number("W"))
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def _dimensions(node):
    return int(node.noise_dimensions[0])


def _offset(seed, dimensions):
    """Where another noise begins: (d,) in [100, 200]."""
    seed = np.float32(seed)
    places = [(seed,)] if dimensions == 1 else [(seed, np.float32(i)) for i in range(dimensions)]
    return np.array([100 + 100 * hashed_number(*place) for place in places], np.float32)


def _fractal_of(node, inputs):
    """function(places (n, d)) to (n,): the fractal that a node Noise makes."""
    kind = getattr(node, "noise_type", "FBM")  # from Blender 4.1 on it has those of the node Musgrave, too
    detail, roughness = inputs.number("Detail"), inputs.number("Roughness")
    lacunarity = inputs.number("Lacunarity") if inputs.has("Lacunarity") else np.float32(2)
    if kind == "FBM" and getattr(node, "normalize", True):
        return lambda p: 0.5 + 0.5 * fractal(p, detail, roughness, lacunarity)
    if kind not in KINDS:
        raise Unsupported(node, f"its type {kind} has no counterpart")
    # Sockets that a kind has no use for are not there.
    offset, gain = (inputs.number(name) if inputs.has(name) else np.float32(0) for name in ("Offset", "Gain"))
    count, fall = np.clip(detail, 0, 15) + 1, np.maximum(roughness, 0)
    return lambda p: KINDS[kind](Octaves(p, count, fall, lacunarity), offset, gain)


def _noise(node, output, inputs):
    dimensions = _dimensions(node)
    p = points(node, inputs, dimensions) * inputs.number("Scale")[..., None]
    distortion = inputs.number("Distortion")
    if distortion.any():
        p = p + np.stack([signed_noise(p + _offset(i, dimensions)) * distortion for i in range(dimensions)], axis=-1)
    value = _fractal_of(node, inputs)
    if output.type == "VALUE":
        return value(p)
    return np.stack([value(p), value(p + _offset(dimensions, dimensions)), value(p + _offset(dimensions + 1, dimensions))],
                    axis=-1)


def _white_noise(node, output, inputs):
    p = np.moveaxis(points(node, inputs, _dimensions(node)), -1, 0)
    return hashed_number(*p) if output.type == "VALUE" else hashed_vector(*p)


NODES = {"TEX_NOISE": _noise, "TEX_WHITE_NOISE": _white_noise}
